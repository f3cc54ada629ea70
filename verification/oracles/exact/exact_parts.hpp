// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What the exact problems are put together from.

#include <string>

#include "verification/oracles/exact/exact.hpp"
#include "verification/support/scenes.hpp"

namespace firn::exact::parts {

using fixtures::elastic_material;

/// c = √((λ+2μ)/ρ), about 20 m/s.
double sound_speed(const Material& m);

Scene elastic_scene(const std::string& name, double h, double dt, double alpha);

/// 8 per cell on a lattice over cells_x × cells_y × cells_z cells.
void fill(ExactProblem& problem, int cells_x, int cells_y, int cells_z);

}  // namespace firn::exact::parts
