// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The composition root: the one place that names the concrete solvers and families.

#include <string>

#include "firn/registry.hpp"

namespace firn {

/// Adds every solver that comes with Firn, and the families: mutants, exercises, guests.
void register_solvers(Registry& registry);

/// The instruction set that the optimized solver uses: "SSE4", "AVX2", "AVX3", "NEON".
std::string instruction_set();

}  // namespace firn
