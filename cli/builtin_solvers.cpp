#include "cli/builtin_solvers.hpp"

#include "optimized/optimized_solver.hpp"
#include "reference/reference_solver.hpp"

namespace firn::cli {

void register_builtin_solvers(Registry& registry) {
  registry.add(reference_entry());
  registry.add(optimized_entry());
}

}  // namespace firn::cli
