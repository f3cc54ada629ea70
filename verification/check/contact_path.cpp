// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/contact_path.hpp"

#include <algorithm>
#include <limits>

#include "verification/check/comparison.hpp"
#include "verification/check/fields.hpp"

namespace firn::check {

namespace {

/// Distance in units of the outcome's own bounds.
double distance(const ContactOutcome& outcome, const Vec3& v, const Mat3* free) {
  const double tiny = std::numeric_limits<double>::min();
  double d = (v - outcome.v).norm() / (outcome.v_error + tiny);
  if (free) d = std::max(d, (*free - outcome.free).norm() / (outcome.free_error + tiny));
  return d;
}

int nearest_outcome(const std::vector<ContactOutcome>& outcomes, const Vec3& v, const Mat3* free) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    const double d = distance(outcomes[k], v, free);
    if (d < least) best = k, least = d;
  }
  return static_cast<int>(best);
}

/// Puts the chosen outcomes into a state after that contact stage. The reference's own stays
/// as the reference computed it.
void apply(const BoundModel& model, Stage stage, const Choices& choices, State& state) {
  for (std::size_t c = 0; c < choices.size(); ++c) {
    if (choices[c] <= 0) continue;
    const DoubtfulContact& contact = model.doubtful()[c];
    const ContactOutcome& chosen = contact.outcomes[static_cast<std::size_t>(choices[c])];
    if (stage == Stage::particle_collisions) {
      state.particles.v[contact.index] = chosen.v;
      continue;
    }
    state.grid.v_star[contact.index] = chosen.v;
    if (!state.grid.free_directions.empty())
      state.grid.free_directions[contact.index] = chosen.free;
  }
}

void choose(BoundModel& model, const Choices& choices) {
  for (std::size_t c = 0; c < choices.size(); ++c) model.choose(model.doubtful()[c], choices[c]);
}

}  // namespace

Choices nearest(const BoundModel& model, Stage stage, const State& reference,
                const State& subject) {
  Choices choices;
  for (const DoubtfulContact& contact : model.doubtful()) {
    if (stage == Stage::particle_collisions) {
      choices.push_back(
          nearest_outcome(contact.outcomes, subject.particles.v[contact.index], nullptr));
      continue;
    }
    const Grid& theirs = subject.grid;
    const NodeIndex& node = reference.grid.node[contact.index];
    const auto it = std::lower_bound(theirs.node.begin(), theirs.node.end(), node);
    const auto j = static_cast<std::size_t>(it - theirs.node.begin());
    if (it == theirs.node.end() || !(*it == node) || theirs.v_star.size() != theirs.size()) {
      choices.push_back(0);
      continue;
    }
    const bool projectors =
        !reference.grid.free_directions.empty() && theirs.free_directions.size() == theirs.size();
    choices.push_back(nearest_outcome(contact.outcomes, theirs.v_star[j],
                                      projectors ? &theirs.free_directions[j] : nullptr));
  }
  return choices;
}

Path follow(const Scene& scene, Solver& reference, const Fork& fork, const Choices& choices,
            Stage stop, double dt, const State& subject) {
  Path path{fork.after, fork.model};
  apply(path.model, fork.stage, choices, path.after);
  choose(path.model, choices);
  if (fork.stage == stop) return path;
  reference.load(scene, path.after);
  State before;
  for (Stage stage = next(fork.stage);; stage = next(stage)) {
    std::swap(before, path.after);
    const bool indefinite = reference.advance_through(stage, dt).solver_indefinite;
    reference.store(path.after);
    path.model.advance(stage, before, path.after, dt, indefinite);
    if (stage == Stage::particle_collisions && !path.model.doubtful().empty()) {
      const Choices later = nearest(path.model, stage, path.after, subject);
      apply(path.model, stage, later, path.after);
      choose(path.model, later);
      reference.load(scene, path.after);
    }
    if (stage == stop) return path;
  }
}

bool fits(const Scene& scene, const Path& path, const State& subject) {
  for (const Field field : particle_fields) {
    FieldRow row(Stage::rasterize, Stage::positions, Stage::positions, field, false);
    FieldComparison{scene,          path.after, subject, path.model.bounds(), path.model.stencils(),
                    path.after.step}
        .run(row);
    if (!row.check().valid) return false;
  }
  return true;
}

}  // namespace firn::check
