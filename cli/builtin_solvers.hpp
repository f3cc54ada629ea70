#pragma once
/// The composition root: the one place that names the concrete solvers.

#include <string>

#include "firn/registry.hpp"

namespace firn::cli {

void register_builtin_solvers(Registry& registry);

/// The instruction set that the optimized solver uses: "SSE4", "AVX2", "AVX3", "NEON".
std::string instruction_set();

}  // namespace firn::cli
