// SPDX-License-Identifier: BSD-3-Clause
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

/// "exercise:N", the mutant of that exercise under a name that does not tell.
SolverFamily exercise_family();

}  // namespace firn::teach
