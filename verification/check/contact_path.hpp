// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The reference's path through a step in which contact is in doubt (contact_outcomes.hpp),
/// with the outcomes that the subject chose.

#include <optional>
#include <vector>

#include "firn/solver.hpp"
#include "verification/check/bounds.hpp"

namespace firn::check {

/// The reference right after a contact stage with doubtful contacts, and its bounds there.
struct Fork {
  State after;
  BoundModel model;
  Stage stage;  ///< grid_collisions or particle_collisions
};

/// Where a path through the stages has come to, and the bounds there.
struct Path {
  State after;
  BoundModel model;
};

/// For each of model.doubtful() the place of an outcome; −1: not known.
using Choices = std::vector<int>;

/// The outcomes nearest to a subject's state, which stands after the fork's stage: by v_i* and
/// projectors at nodes, by v_p at particles.
Choices nearest(const BoundModel& model, Stage stage, const State& reference, const State& subject);

/// The way from the fork through `stop` with these choices at its contacts. Those of step 9, if
/// it comes later, are the nearest to the subject's v_p after `stop`.
Path follow(const Scene& scene, Solver& reference, const Fork& fork, const Choices& choices,
            Stage stop, double dt, const State& subject);

/// Are all numbers of the subject's particles within their bounds of this path?
bool fits(const Scene& scene, const Path& path, const State& subject);

}  // namespace firn::check
