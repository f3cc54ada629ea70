// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Step 5 or step 9 alone, with velocities of the caller's choice.

#include <cmath>
#include <vector>

#include "verification/suite/probes.hpp"

namespace firn::suite {

inline Collider plane(const Vec3& point, const Vec3& normal, double friction) {
  Collider c;
  c.shape = HalfSpace{point, normal};
  c.center = point;
  c.friction = friction;
  return c;
}

/// Velocities before and after step 5 or step 9, and where they are.
struct Collided {
  std::vector<Vec3> x, before, after;
  std::vector<Mat3> free_directions;  ///< of nodes, in semi-implicit scenes
};

/// A cube of particles around the origin; the velocities of nodes or particles that go into the
/// collision are set by `velocity(x)`.
template <class Velocity>
Collided collide(Scene scene, bool nodes, const Velocity& velocity, double time = 0) {
  State state;
  Particles& p = state.particles;
  fixtures::Random random(51);
  p.resize(static_cast<std::size_t>(effort(500, 100)));
  for (std::size_t q = 0; q < p.size(); ++q) {
    for (int a = 0; a < 3; ++a) p.x[q][a] = spacing * std::floor(3 * random() * 1024) / 1024;
    p.m[q] = 1;
    p.V_0[q] = 0x1p-12;
    p.id[q] = static_cast<std::int64_t>(q);
  }
  state.time = time;
  const double dt = 0x1p-12;
  const Stage stage = nodes ? Stage::grid_collisions : Stage::particle_collisions;
  Scene empty = scene;
  empty.colliders.clear();
  state = before_stage(empty, state, stage, dt);
  Collided result;
  if (nodes) {
    for (std::size_t i = 0; i < state.grid.size(); ++i) {
      result.x.push_back(position(scene, state.grid.node[i]));
      state.grid.v_star[i] = rounded(velocity(result.x[i]));
    }
    result.before = state.grid.v_star;
    const Grid after = run_through(scene, state, stage, dt).grid;
    result.after = after.v_star;
    result.free_directions = after.free_directions;
  } else {
    result.x = state.particles.x;
    for (std::size_t q = 0; q < result.x.size(); ++q)
      state.particles.v[q] = rounded(velocity(result.x[q]));
    result.before = state.particles.v;
    result.after = run_through(scene, state, stage, dt).particles.v;
  }
  return result;
}

/// Particles near a moving surface may be on either side of it after rounding: a distance below
/// which nothing is asked [m]. Nodes are where they are.
inline double doubtful(const Vec3& x) { return 8 * eps() * (x.norm() + 4 * spacing); }

}  // namespace firn::suite
