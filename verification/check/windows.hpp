// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Which steps of a scene a check compares, if nobody says: those in which something happens.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "verification/check/check.hpp"

namespace firn {

struct WindowPlan {
  std::vector<CheckWindow> windows;  ///< of one step each, in the order of the scene
  std::int64_t looked_at = 0;        ///< steps whose features were counted
  std::int64_t passed = 0;           ///< steps that the scout took
  bool complete = false;             ///< false: the budget ended before the scene did
  bool interrupted = false;
  Exercised seen;  ///< in all steps that were looked at
};

struct WindowOptions {
  std::int64_t steps = 10;  ///< ≥ 1, to choose
  double budget = 30;       ///< [s], for looking
  /// Called with the share of the scene that was looked at; false ends it.
  std::function<bool(double done)> progress{};
};

/// Runs the scene once with `scout`, counts the features of every k-th step, and chooses steps
/// such that every feature that was seen is in one of them, as far as `options.steps` suffice;
/// what is left goes to the longest gaps between them. k follows from the size of the
/// scene alone, so that the same steps come out everywhere unless the budget ends the search.
WindowPlan plan_windows(const Scene& scene, const State& initial, Solver& scout,
                        const WindowOptions& options);

/// The steps that plan_windows() takes from what it counted, ascending; for tests.
struct Sighting {
  std::int64_t step = 0;
  Exercised exercised;  ///< of this step alone
};
std::vector<std::int64_t> choose_steps(const std::vector<Sighting>& sightings, std::int64_t steps);

}  // namespace firn
