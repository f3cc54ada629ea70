// SPDX-License-Identifier: BSD-3-Clause
/// Contact and friction, at nodes and at particles.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "verification/suite/collided.hpp"

namespace firn::suite {
namespace {

bool same_bits(const Vec3& a, const Vec3& b) {
  return std::memcmp(a.data(), b.data(), 3 * sizeof(double)) == 0;
}

/// Everything that step 5 or 9 promises, for any velocities and several colliders.
void all_properties(bool nodes) {
  Scene scene = plain_scene();
  Collider slope = plane(spacing * Vec3(0.3, -0.2, 0.1), Vec3(0.2, 0.1, 1), 0.4);
  slope.velocity = Vec3(0.25, 0, 0.125);
  slope.angular_velocity = Vec3(0.5, -1, 2);
  scene.colliders = {slope};
  fixtures::Random random(52);
  const auto any = [&](const Vec3&) { return random.vec3(); };
  const Collided c = collide(scene, nodes, any);
  ASSERT_EQ(c.after.size(), c.before.size());
  std::int64_t touched = 0, changed = 0, wrong_side = 0;
  for (std::size_t k = 0; k < c.x.size(); ++k) {
    const Contact contact = slope.contact(c.x[k], 0);
    if (std::abs(contact.phi) < doubtful(c.x[k])) continue;
    const Vec3 old = c.before[k] - contact.velocity, now = c.after[k] - contact.velocity;
    const double v_n = old.dot(contact.normal),
                 scale = 1 + c.before[k].norm() + contact.velocity.norm();
    // The normal, v_co and three short sums: ten roundings of |v| + |v_co|; the rotation of the
    // collider's centre costs as many again.
    const double roundoff = 20 * eps() * scale;
    if (contact.phi > 0 || v_n >= roundoff) {
      ++(contact.phi > 0 ? wrong_side : touched);
      changed += same_bits(c.before[k], c.after[k]) ? 0 : 1;
      continue;
    }
    if (std::abs(v_n) < roundoff) continue;
    ++touched;
    const Vec3 v_t = old - v_n * contact.normal;
    within("normal velocity after contact is 0", now.dot(contact.normal), roundoff);
    const double lost = std::min(-slope.friction * v_n, v_t.norm());
    const Vec3 now_t = now - now.dot(contact.normal) * contact.normal;
    within("|Δv_t| = min(μ|v_n|, |v_t|)", (v_t - now_t).norm() - lost, roundoff);
    within("friction acts against v_t", (now_t - (1 - lost / v_t.norm()) * v_t).norm(),
           roundoff * (1 + 1 / v_t.norm() * slope.friction));
  }
  expect("outside, or leaving: not a bit changes", changed == 0,
         fmt::format("{} changed", changed));
  expect("contacts were made", touched > 20 && wrong_side > 20);

  // A second time changes nothing but roundoff.
  std::size_t at = 0;
  const Collided again = collide(scene, nodes, [&](const Vec3&) { return c.after[at++]; });
  for (std::size_t k = 0; k < c.x.size(); ++k)
    within("idempotent", (again.after[k] - c.after[k]).norm(),
           20 * eps() * (2 + c.after[k].norm()));

  // Seen from a moving frame nothing changes.
  const Vec3 U(0.5, -2, 1);
  Scene moving = scene;
  moving.colliders[0].velocity += U;
  at = 0;
  const Collided galilei =
      collide(moving, nodes, [&](const Vec3&) { return Vec3(c.before[at++] + U); });
  for (std::size_t k = 0; k < c.x.size(); ++k) {
    const Contact contact = slope.contact(c.x[k], 0);
    const double v_n = (c.before[k] - contact.velocity).dot(contact.normal);
    if (std::abs(contact.phi) < doubtful(c.x[k]) || std::abs(v_n) < 40 * eps()) continue;
    within("Galilean invariance", (galilei.after[k] - U - c.after[k]).norm(),
           40 * eps() * (3 + U.norm()));
  }

  scene.colliders[0].sticky = true;
  at = 0;
  const Collided stuck = collide(scene, nodes, [&](const Vec3&) { return c.before[at++]; });
  for (std::size_t k = 0; k < c.x.size(); ++k) {
    const Contact contact = slope.contact(c.x[k], 0);
    if (contact.phi > 0 || std::abs(contact.phi) < doubtful(c.x[k])) continue;
    within("sticky: v = v_co, whatever v_n", (stuck.after[k] - contact.velocity).norm(),
           20 * eps() * (1 + contact.velocity.norm()));
  }
}

FIRN_TEST(Collisions, of_nodes) {
  FIRN_NEEDS_STOP(Stage::grid_velocities);
  FIRN_NEEDS_STOP(Stage::grid_collisions);
  all_properties(true);
}

FIRN_TEST(Collisions, of_particles) {
  FIRN_NEEDS_STOP(Stage::particle_velocities);
  FIRN_NEEDS_STOP(Stage::particle_collisions);
  all_properties(false);
}

/// One particle inside the solid, so that its nodes and itself are in contact all the time.
State point_particle(const Vec3& x, const Vec3& v) {
  State state;
  state.particles.resize(1);
  state.particles.x[0] = x;
  state.particles.v[0] = v;
  state.particles.m[0] = 1;
  state.particles.V_0[0] = spacing * spacing * spacing;
  return state;
}

/// v_t = nΔt g (sin θ − μ cos θ) if that is positive, at rest to the bit otherwise.
FIRN_TEST(Collisions, point_on_an_incline) {
  const double dt = 0x1p-10;
  const int steps = effort(100, 10);
  for (const double mu : {0.25, 1.5}) {
    Scene scene = plain_scene();
    scene.gravity = Vec3(0, 0, -8);
    // tan θ = 3/4: sin θ = 0.6, cos θ = 0.8.
    scene.colliders = {plane(Vec3::Zero(), Vec3(0.6, 0, 0.8), mu)};
    const State after =
        run_steps(scene, point_particle(spacing * Vec3(0.25, 0.5, -5), Vec3::Zero()), steps, dt);
    const double expected = std::max(0.0, steps * dt * 8 * (0.6 - mu * 0.8));
    const Vec3 downhill(0.8, 0, -0.6);
    const Vec3 off = after.particles.v[0] - expected * downhill;
    if (expected > 0)
      within("v_t = nΔt g (sin θ − μ cos θ)", off.norm(), 40 * eps() * steps * dt * 8);
    else
      within("steep friction: at rest", after.particles.v[0].norm(), 4 * eps() * dt * 8);
  }
}

/// A belt at speed U drags a particle along: v0 + nμgΔt until it sticks.
FIRN_TEST(Collisions, conveyor) {
  const double dt = 0x1p-10, mu = 0.5, g = 8, U = 0.25;
  Scene scene = plain_scene();
  scene.gravity = Vec3(0, 0, -g);
  Collider belt = plane(Vec3::Zero(), Vec3(0, 0, 1), mu);
  belt.velocity = Vec3(U, 0, 0);
  scene.colliders = {belt};
  const auto sticks = static_cast<int>(std::ceil(U / (mu * g * dt)));
  const auto solver = make_subject();
  const State initial = point_particle(spacing * Vec3(0.25, 0.5, -3), Vec3::Zero());
  solver->load(scene, initial);
  State state;
  const int steps = effort(sticks + 10, 8);
  for (int n = 1; n <= steps; ++n) {
    solver->step(dt);
    solver->store(state);
    // Grid and particle collide in the same step; the grid's friction has done the step's whole
    // work, and the particle finds v_n = 0.
    const double expected = n >= sticks ? U : n * mu * g * dt;
    within("v = min(v0 + nμgΔt, U)", (state.particles.v[0] - Vec3(expected, 0, 0)).norm(),
           40 * eps() * (U + n * dt * g));
  }
}

/// A particle inside a turning, sticky drum moves with v_co = ω × r.
FIRN_TEST(Collisions, rotating_collider) {
  Scene scene = plain_scene();
  Collider drum;
  drum.shape = Sphere{Vec3::Zero(), 1};
  drum.sticky = true;
  drum.angular_velocity = Vec3(0.5, 0.25, 2);
  drum.velocity = Vec3(0.125, 0, 0);
  scene.colliders = {drum};
  const Vec3 x = spacing * Vec3(3.25, -2.5, 1.75);
  const State after = run_steps(scene, point_particle(x, Vec3(1, 1, 1)), 1, 0x1p-10);
  const Vec3 expected = drum.velocity + drum.angular_velocity.cross(x);
  within("v_p = v_co = velocity + ω × r", (after.particles.v[0] - expected).norm(),
         20 * eps() * (1 + expected.norm()));
}

/// An elastic block slides down an incline: v_t = gT sin θ − μ (gT cos θ + v_n), where v_n is what
/// it still carries along the normal.
FIRN_TEST(Collisions, block_on_an_incline) {
  if (subject().slow) GTEST_SKIP() << "every step starts a program: too long";
  Scene scene = plain_scene();
  const double theta = 0.5, mu = 0.2, g = 9.8125, h = spacing;
  scene.flip = 0.95;
  scene.gravity = g * Vec3(std::sin(theta), 0, -std::cos(theta));
  scene.colliders = {plane(Vec3(0, 0, -0.3 * h), Vec3(0, 0, 1), mu)};
  State state;
  Particles& p = state.particles;
  std::vector<Vec3> x;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      for (int k = 0; k < 8; ++k) x.push_back(h / 2 * Vec3(i + 0.5, j + 0.5, k + 0.5));
  p.resize(x.size());
  p.x = x;
  for (std::size_t q = 0; q < x.size(); ++q) {
    p.V_0[q] = h * h * h / 8;
    p.m[q] = 400 * p.V_0[q];
    p.id[q] = static_cast<std::int64_t>(q);
  }
  const double dt = 0x1p-11;
  const int steps = 600;
  const State after = run_steps(scene, state, steps, dt);
  const Totals t = totals(after.particles);
  const double T = steps * dt, v_n = t.momentum[2] / t.mass;
  const double expected = g * T * std::sin(theta) - mu * (g * T * std::cos(theta) + v_n);
  // Friction is that of each node, whose share of the weight jitters: 1 % of the speed.
  within("v_t of a sliding block", t.momentum[0] / t.mass - expected, 0.01 * expected);
}

}  // namespace
}  // namespace firn::suite
