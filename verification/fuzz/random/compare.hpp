// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// One random scene, one solver: does it agree, and if not, how small can the scene be?

#include <functional>
#include <memory>
#include <string>

#include "firn/solver.hpp"
#include "verification/fuzz/random/random_scene.hpp"

namespace firn {

enum class Agreement {
  valid,
  invalid,
  reference_failed,  ///< the reference cannot take these steps: nothing to compare
  /// The solver says that numbers leave its range, and stops: the hardening e^{ξ(1−J_P)} is
  /// beyond float (J_P < −7.8 at ξ = 10), or a particle moves more than the 4 cells in one
  /// step that the optimized solver allows. Scenes that explode get there.
  out_of_range,
};

struct Comparison {
  Agreement agreement = Agreement::valid;
  std::string message;        ///< the first divergence, or why a solver stopped
  std::int64_t compared = 0;  ///< numbers
  double largest_in_bounds = 0;
};

/// A new solver, for every comparison.
using MakeSolver = std::function<std::unique_ptr<Solver>()>;

/// Lockstep check (verification/check) of the case.
Comparison compare(const RandomCase& c, const MakeSolver& reference, const MakeSolver& subject);

/// A smaller case that still fails: bodies, colliders, motions, steps and particles are
/// taken away as long as it does. Takes at most `most_attempts` comparisons.
RandomCase shrink(RandomCase failing, const std::function<bool(const RandomCase&)>& fails,
                  std::int64_t max_particles, int most_attempts = 400);

}  // namespace firn
