// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Deliberately wrong solvers: the reference with one small named patch each, one
/// plausible mistake. Whoever claims to find mistakes has to find these:
/// `firn check SCENE --solver mutant:NAME`, `firn verify --solver mutant:NAME`.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "firn/registry.hpp"
#include "firn/solver.hpp"

namespace firn {

namespace mutants {
struct Stages;
}

struct Mutant {
  std::string name;     ///< snake_case
  Stage stage;          ///< where the mistake lives; of several stages the first
  bool several;         ///< it lives in more than one stage, or between steps
  std::string mistake;  ///< what was changed, one line
  std::string origin;   ///< how people come to make it, one line
  /// What a scene must have for the mistake to matter; empty: any lump of snow that
  /// yields and touches a collider.
  std::string needs;
  /// False: within roundoff of the truth in any one run of good input, so that lockstep has
  /// nothing to say; or `needs` more particles, steps, distance or exactness than the cases that
  /// lockstep is given. Properties of many runs, bad input and the suite's ladders show it.
  bool check_sees_it;
  std::function<void(mutants::Stages&)> patch;
};

/// All of them, in the order of the stages.
const std::vector<Mutant>& all_mutants();

/// "mutant:NAME", in double only.
SolverFamily mutant_family();

}  // namespace firn
