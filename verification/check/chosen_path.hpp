// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Which path through a stretch with doubtful contact did the subject take?

#include "firn/solver.hpp"
#include "verification/check/contact_path.hpp"

namespace firn::check {

/// A stretch that the subject has run.
struct Stretch {
  const Scene& scene;
  Solver& reference;
  const State& input;   ///< with which both were loaded
  const State& result;  ///< the subject's, at the end of the stretch
  double dt;
};

/// The reference's path from `fork` through `stop` with the subject's choices. Those at nodes
/// are read off `with_grid`, the subject's state at a stop from step 5 to 9 on the same way, or,
/// without one (null), off its particles. What cannot be read leaves wide bounds. Leaves the
/// reference anywhere.
Path chosen_path(const Stretch& stretch, const Fork& fork, Stage stop, const State* with_grid);

}  // namespace firn::check
