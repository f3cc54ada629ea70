#include "cli/builtin_solvers.hpp"

#include "optimized/optimized_solver.hpp"
#include "reference/reference_solver.hpp"

namespace firn::cli {

void register_builtin_solvers(Registry& registry) {
  registry.add(reference_entry());
  registry.add(optimized_entry());
}

std::string instruction_set() { return optimized_target_name(); }

}  // namespace firn::cli
