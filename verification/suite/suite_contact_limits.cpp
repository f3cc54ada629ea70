// SPDX-License-Identifier: BSD-3-Clause
/// Contact where a condition holds with equality: ‖v_t‖ = −μ v_n, φ = 0, v_n = 0, v_t = 0.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "verification/suite/collided.hpp"

namespace firn::suite {
namespace {

/// ‖v_t‖ = −μ v_n exactly sticks; φ = 0 exactly is contact.
void limits(bool nodes) {
  Scene scene = plain_scene();
  scene.colliders = {plane(Vec3::Zero(), Vec3(0, 0, 1), 0.5)};
  const auto touching = [](const Vec3& x) { return x[2] <= 0; };
  // v_t = (0.75, 1, 0): 1.25 = 0.5 · 2.5, all of it exact in binary.
  const Collided limit = collide(scene, nodes, [](const Vec3&) { return Vec3(0.75, 1, -2.5); });
  std::int64_t at_zero = 0;
  double stuck = 0, free = 0;
  for (std::size_t k = 0; k < limit.x.size(); ++k) {
    (touching(limit.x[k]) ? stuck : free) +=
        touching(limit.x[k]) ? limit.after[k].norm() : (limit.after[k] - limit.before[k]).norm();
    at_zero += limit.x[k][2] == 0 ? 1 : 0;
  }
  expect("‖v_t‖ = −μ v_n sticks exactly", stuck == 0);
  expect("φ > 0 is free", free == 0);
  if (nodes) expect("nodes at φ = 0 exactly", at_zero > 0);

  // Two planes in scene order: the second has the last word.
  Scene corner = scene;
  corner.colliders = {plane(Vec3::Zero(), Vec3(0, 0, 1), 0), plane(Vec3::Zero(), Vec3(3, 0, 4), 0)};
  const Collided both = collide(corner, nodes, [](const Vec3&) { return Vec3(-1, 0.25, -1); });
  for (std::size_t k = 0; k < both.x.size(); ++k) {
    const Vec3 n2(0.6, 0, 0.8);
    if (std::abs(both.x[k].dot(n2)) < doubtful(both.x[k])) continue;
    Vec3 v(-1, 0.25, -1);
    if (both.x[k][2] <= 0) v -= std::min(0.0, v[2]) * Vec3(0, 0, 1);
    if (both.x[k].dot(n2) <= 0) v -= std::min(0.0, v.dot(n2)) * n2;
    within("two planes, one after the other", (both.after[k] - v).norm(), 20 * eps());
  }
}

FIRN_TEST(Collisions, limits_at_nodes) {
  FIRN_NEEDS_STOP(Stage::grid_velocities);
  FIRN_NEEDS_STOP(Stage::grid_collisions);
  limits(true);
}

FIRN_TEST(Collisions, limits_at_particles) {
  FIRN_NEEDS_STOP(Stage::particle_velocities);
  FIRN_NEEDS_STOP(Stage::particle_collisions);
  limits(false);
}

/// A collider and v_rel = `tangential` + v_n (0, 0, 1) at its surface, whose normal is (0, 0, 1).
/// Every number is exact.
struct ExactContact {
  double friction;
  bool sticky;
  Vec3 v_co, tangential;
  double v_n;

  Vec3 v_rel() const { return tangential + v_n * Vec3::UnitZ(); }
  Vec3 v() const { return v_co + v_rel(); }
  bool leaves() const { return !sticky && v_n >= 0; }
  /// v_rel after the contact; 0: it sticks.
  Vec3 after() const {
    if (leaves()) return v_rel();
    const double slip = tangential.norm();
    if (sticky || slip <= -friction * v_n) return Vec3::Zero();
    return (1 + friction * v_n / slip) * tangential;
  }
  /// The directions left to the solve of step 6.
  Mat3 free_directions() const {
    if (leaves()) return Mat3::Identity();
    return after().isZero(0) ? Mat3(Mat3::Zero()) : Mat3(Vec3(1, 1, 0).asDiagonal());
  }
  /// The row it belongs to, and which of its contacts it is.
  std::string kind() const {
    const char* sign = v_n > 0 ? ">" : v_n < 0 ? "<" : "=";
    return fmt::format("{}, v_n {} 0, {}",
                       sticky         ? "sticky"
                       : friction > 0 ? "friction"
                                      : "smooth",
                       sign, tangential.isZero(0) ? "no slip" : "slip");
  }
  std::string text() const {
    return fmt::format("v_n = {:.3g}, v_co = ({}, {}, {})", v_n, v_co[0], v_co[1], v_co[2]);
  }
};

/// For each collider: v_n from 1 m/s outwards to 1 m/s inwards over 0 exactly, with slip and
/// without.
std::vector<std::vector<ExactContact>> exact_contacts() {
  std::vector<std::vector<ExactContact>> colliders;
  for (const Vec3& v_co : {Vec3(0, 0, 0), Vec3(0.25, -1, 0.5)})
    for (const double friction : {-1.0, 0.0, 0.5}) {
      std::vector<ExactContact> list;
      for (const double v_n : {1.0, 0x1p-20, 0.0, -0x1p-20, -1.0})
        for (const Vec3& tangential : {Vec3(0, 0, 0), Vec3(0.75, 1, 0)})
          list.push_back({std::max(friction, 0.0), friction < 0, v_co, tangential, v_n});
      colliders.push_back(list);
    }
  return colliders;
}

Scene scene_of(const ExactContact& c, const Vec3& point) {
  Scene scene = plain_scene();
  Collider ground = plane(point, Vec3(0, 0, 1), c.friction);
  ground.sticky = c.sticky;
  ground.velocity = c.v_co;
  scene.colliders = {ground};
  return scene;
}

/// One contact after the other for the nodes or particles of a cube.
void exact(bool nodes) {
  for (const std::vector<ExactContact>& contacts : exact_contacts()) {
    Scene scene = scene_of(contacts[0], Vec3::Zero());
    if (nodes && solves_implicitly()) scene.integrator.type = IntegratorType::semi_implicit;
    std::size_t next = 0;
    const Collided done =
        collide(scene, nodes, [&](const Vec3&) { return contacts[next++ % contacts.size()].v(); });
    for (std::size_t k = 0; k < done.x.size(); ++k) {
      if (done.x[k][2] > 0) continue;
      const ExactContact& c = contacts[k % contacts.size()];
      within(c.kind(), (done.after[k] - c.v_co - c.after()).norm(), 8 * eps() * (1 + c.v().norm()),
             c.text());
      if (c.leaves())
        expect(c.kind() + ": not a bit changes",
               std::memcmp(&done.after[k], &done.before[k], sizeof(Vec3)) == 0, c.text());
      if (k < done.free_directions.size())
        within(c.kind() + ": directions left free",
               (done.free_directions[k] - c.free_directions()).norm(), 8 * eps(), c.text());
    }
  }
}

FIRN_TEST(Collisions, exact_at_nodes) {
  FIRN_NEEDS_STOP(Stage::grid_velocities);
  FIRN_NEEDS_STOP(Stage::grid_collisions);
  exact(true);
}

FIRN_TEST(Collisions, exact_at_particles) {
  FIRN_NEEDS_STOP(Stage::particle_velocities);
  FIRN_NEEDS_STOP(Stage::particle_collisions);
  exact(false);
}

/// The same in whole steps, for pairs of particles with nodes of their own: one above the surface,
/// half of whose nodes are below; with α = 1 it loses what its nodes lose. And one inside, which
/// collides in step 9 as well.
FIRN_TEST(Collisions, exact_in_a_whole_step) {
  for (const std::vector<ExactContact>& contacts : exact_contacts()) {
    const Scene scene = scene_of(contacts[0], spacing * Vec3(0, 0, 0.125));
    State state;
    Particles& p = state.particles;
    p.resize(2 * contacts.size());
    for (std::size_t q = 0; q < p.size(); ++q) {
      const Vec3 place(0.3125 + 8 * static_cast<double>(q / 2), 0.5, q % 2 == 0 ? 0.25 : -8.5);
      p.x[q] = spacing * place;
      p.v[q] = contacts[q / 2].v();
      p.m[q] = 1;
      p.V_0[q] = spacing * spacing * spacing;
      p.id[q] = static_cast<std::int64_t>(q);
    }
    const double above = static_cast<double>(N(Real(0.25) - 1) + N(Real(0.25) - 2));
    const Particles after = run_steps(scene, state, 1, 0x1p-13).particles;
    for (std::size_t q = 0; q < p.size(); ++q) {
      const ExactContact& c = contacts[q / 2];
      const double share = q % 2 == 0 ? above : 0;
      // 64 roundings of a node's velocity: what is 0 in v_p may be one there.
      within(c.kind() + (q % 2 == 0 ? ", beside it" : ", inside"),
             (after.v[q] - c.v_co - share * c.v_rel() - (1 - share) * c.after()).norm(),
             64 * eps() * (1 + 2 * c.v().norm()), c.text());
    }
  }
}

}  // namespace
}  // namespace firn::suite
