// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/chosen_path.hpp"

#include "verification/check/inferred_contact.hpp"

namespace firn::check {

namespace {

/// Of whole steps alone: first the two choices that a solver makes which rounds all doubtful
/// contacts alike, then the particles' account.
Path path_of_particles(const Stretch& s, const Fork& fork, Stage stop) {
  const auto go = [&](const Choices& choices) {
    return follow(s.scene, s.reference, fork, choices, stop, s.dt, s.result);
  };
  const std::size_t n = fork.model.doubtful().size();
  const Path own = go(Choices(n, 0));
  if (fits(s.scene, own, s.result)) return own;
  Path other = go(Choices(n, 1));
  if (fits(s.scene, other, s.result)) return other;
  if (s.scene.semi_implicit()) return go(Choices(n, -1));
  return go(inferred_choices(s.scene, fork, own, s.input.particles, s.result.particles, s.dt));
}

}  // namespace

Path chosen_path(const Stretch& s, const Fork& fork, Stage stop, const State* with_grid) {
  if (fork.stage == Stage::grid_collisions && !with_grid) return path_of_particles(s, fork, stop);
  const State& told = fork.stage == Stage::grid_collisions ? *with_grid : s.result;
  return follow(s.scene, s.reference, fork, nearest(fork.model, fork.stage, fork.after, told), stop,
                s.dt, s.result);
}

}  // namespace firn::check
