#pragma once
/// The composition root: the one place that names the concrete solvers.

#include "firn/registry.hpp"

namespace firn::cli {

void register_builtin_solvers(Registry& registry);

}  // namespace firn::cli
