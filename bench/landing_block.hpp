// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The scene of the suite `implicit`.

#include <cstdint>

#include "firn/scene.hpp"

namespace firn::bench {

/// A cube of the paper's snow with another stiffness, `cells` along an edge with 8 particles
/// each, jittered, that has just reached a floor with friction at 1.5 m/s. Explicit; Δt from
/// the sound speed of undeformed snow at half a cell, which hardening snow needs (Δt_explicit).
Scene landing_block(double youngs_modulus, double cells, std::uint64_t seed);

/// The same with steps of `factor` times Δt_explicit.
Scene in_large_steps(Scene scene, double factor, double tolerance);

}  // namespace firn::bench
