// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/solvers.hpp"

#include "guests/guests.hpp"
#include "optimized/optimized_solver.hpp"
#include "reference/reference_solver.hpp"
#include "teach/exercises.hpp"
#include "verification/mutants/mutants.hpp"

namespace firn {

void register_solvers(Registry& registry) {
  registry.add(reference_entry());
  registry.add(optimized_entry());
  registry.add_family(mutant_family());
  registry.add_family(teach::exercise_family());
  registry.add_family(command_guests());
  registry.add_family(library_guests());
}

std::string instruction_set() { return optimized_target_name(); }

}  // namespace firn
