#pragma once
/// Planted bugs by number, so that their names do not give them away:
/// `firn check SCENE --solver exercise:3`.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firn/registry.hpp"
#include "firn/solver.hpp"

namespace firn::teach {

struct Exercise {
  std::string_view mutant;  ///< what is behind it
  std::string_view scene;   ///< a built-in scene in which it shows
};

/// Exercise N is element N − 1, in an order that has nothing to do with the stages.
const std::vector<Exercise>& exercises();

/// True for "exercise:…".
bool names_an_exercise(const std::string& solver);

/// The mutant of "exercise:N" under that name. Throws InputError for any other N.
std::unique_ptr<Solver> make_exercise_solver(const std::string& solver,
                                             const SolverOptions& options);

}  // namespace firn::teach
