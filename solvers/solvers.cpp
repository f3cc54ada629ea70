#include "solvers/solvers.hpp"

#include "optimized/optimized_solver.hpp"
#include "reference/reference_solver.hpp"

namespace firn {

void register_solvers(Registry& registry) {
  registry.add(reference_entry());
  registry.add(optimized_entry());
}

std::string instruction_set() { return optimized_target_name(); }

}  // namespace firn
