// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "reference/collision.hpp"
#include "reference/steps.hpp"
#include "verification/support/eps.hpp"
#include "verification/tests/reference/scenes.hpp"

namespace firn::reference {
namespace {

Contact floor_contact() { return {-0.1, Vec3::UnitZ(), Vec3::Zero()}; }

Collider with_friction(double mu) {
  Collider collider;
  collider.shape = HalfSpace{Vec3::Zero(), Vec3::UnitZ()};
  collider.friction = mu;
  return collider;
}

TEST(Collide, SlidesWithLessTangentialSpeed) {
  // v_n = −2, |v_t| = 5, μ = 0.5: loses μ|v_n| = 1 of 5
  Vec3 v(3, 4, -2);
  EXPECT_EQ(collide(with_friction(0.5), floor_contact(), v), ContactMode::slides);
  EXPECT_LE((v - Vec3(2.4, 3.2, 0)).norm(), 4 * eps);
}

TEST(Collide, SticksBelowTheFrictionLimit) {
  Vec3 v(0.3, 0.4, -2);
  EXPECT_EQ(collide(with_friction(0.5), floor_contact(), v), ContactMode::sticks);
  EXPECT_EQ(v, Vec3(Vec3::Zero()));
}

TEST(Collide, SticksExactlyAtTheLimit) {
  Vec3 v(3, 4, -10);  // ‖v_t‖ = 5 = −μ v_n
  EXPECT_EQ(collide(with_friction(0.5), floor_contact(), v), ContactMode::sticks);
  EXPECT_EQ(v, Vec3(Vec3::Zero()));
}

TEST(Collide, WithoutFrictionOnlyTheNormalPartGoes) {
  Vec3 v(3, 4, -2);
  EXPECT_EQ(collide(with_friction(0), floor_contact(), v), ContactMode::slides);
  EXPECT_EQ(v, Vec3(3, 4, 0));
  Vec3 straight_down(0, 0, -2);  // ‖v_t‖ = 0 ≤ 0: no division by it
  EXPECT_EQ(collide(with_friction(0), floor_contact(), straight_down), ContactMode::sticks);
  EXPECT_EQ(straight_down, Vec3(Vec3::Zero()));
}

TEST(Collide, LeavesSeparatingVelocitiesToTheLastBit) {
  for (const double v_n : {0.0, 1e-300, 2.0}) {
    const Vec3 before(0.1, 0.2, v_n);
    Vec3 v = before;
    EXPECT_EQ(collide(with_friction(0.5), floor_contact(), v), ContactMode::none);
    EXPECT_EQ(v, before);
  }
}

TEST(Collide, OutsideNothingHappens) {
  Contact contact = floor_contact();
  contact.phi = std::numeric_limits<double>::denorm_min();
  Vec3 v(1, 2, -3);
  EXPECT_EQ(collide(with_friction(0.5), contact, v), ContactMode::none);
  EXPECT_EQ(v, Vec3(1, 2, -3));
  contact.phi = 0;  // the surface belongs to the solid
  EXPECT_NE(collide(with_friction(0.5), contact, v), ContactMode::none);
}

TEST(Collide, StickyHoldsWhateverTheNormalVelocity) {
  Collider collider = with_friction(0);
  collider.sticky = true;
  Contact contact = floor_contact();
  contact.velocity = Vec3(1, 2, 3);
  for (const double v_n : {-5.0, 0.0, 5.0}) {
    Vec3 v(7, 8, v_n);
    EXPECT_EQ(collide(collider, contact, v), ContactMode::sticks);
    EXPECT_EQ(v, contact.velocity);
  }
}

TEST(Collide, FrictionTakesTheSmallerOfTwoAmounts) {
  test::Random random(1);
  for (int n = 0; n < 1000; ++n) {
    Contact contact;
    contact.phi = -1;
    contact.normal = random.vec3().normalized();
    contact.velocity = random.vec3();
    const double mu = 1 + random();
    const Vec3 before = random.vec3();
    Vec3 v = before;
    const Vec3 rel = before - contact.velocity;
    const double v_n = rel.dot(contact.normal);
    const double v_t = (rel - v_n * contact.normal).norm();
    const ContactMode mode = collide(with_friction(mu), contact, v);
    if (v_n >= 0) {
      EXPECT_EQ(v, before);
      continue;
    }
    const Vec3 rel_after = v - contact.velocity;
    const double after_t = (rel_after - rel_after.dot(contact.normal) * contact.normal).norm();
    EXPECT_NEAR(rel_after.dot(contact.normal), 0, 10 * eps);
    EXPECT_NEAR(v_t - after_t, std::min(mu * std::abs(v_n), v_t), 20 * eps);
    EXPECT_EQ(mode == ContactMode::sticks, v == contact.velocity);
    Vec3 again = v;  // idempotent
    collide(with_friction(0), contact, again);
    EXPECT_LE((again - v).norm(), 10 * eps);
    Vec3 boosted = before + Vec3(0.5, -1, 2);  // Galilean invariance
    Contact moving = contact;
    moving.velocity += Vec3(0.5, -1, 2);
    collide(with_friction(mu), moving, boosted);
    EXPECT_LE((boosted - Vec3(0.5, -1, 2) - v).norm(), 50 * eps);
  }
}

/// A lone particle in free space: the grid hands its velocity through unchanged.
struct PointParticle {
  explicit PointParticle(const Scene& s) : scene(s), solver(test::make_reference()) {}
  Scene scene;
  std::unique_ptr<Solver> solver;

  Vec3 run(const Vec3& x, const Vec3& v, int steps) {
    State state = test::particles_at_rest(scene);
    state.particles.x[0] = x;
    state.particles.v[0] = v;
    state.particles.V_0[0] = 1e-3;
    solver->load(scene, state);
    for (int n = 0; n < steps; ++n) solver->step(scene.time.step);
    solver->store(state);
    return state.particles.v[0];
  }
};

/// On an incline v_t = nΔt g (sin θ − μ cos θ), or exactly 0 if friction holds it.
TEST(Collisions, PointParticleOnAnIncline) {
  const double theta = 0.5, g = 9.81;
  const Vec3 normal(-std::sin(theta), 0, std::cos(theta));
  const Vec3 downhill(-std::cos(theta), 0, -std::sin(theta));
  for (const double mu : {0.0, 0.2, 0.4, 0.6, 1.0}) {
    Scene scene = test::empty_scene();
    scene.gravity = Vec3(0, 0, -g);
    scene.flip = 1;
    Collider incline = with_friction(mu);
    incline.shape = HalfSpace{Vec3::Zero(), normal};
    scene.colliders = {incline};
    // Deep inside all the nodes are in contact, too: the whole stencil slides.
    const int steps = 100;
    const Vec3 v = PointParticle(scene).run(-0.5 * normal, Vec3::Zero(), steps);
    const double expected =
        steps * scene.time.step * g * std::max(0.0, std::sin(theta) - mu * std::cos(theta));
    // 100 steps, each with 64-term sums of weights and the exact rule of friction
    EXPECT_NEAR(v.dot(downhill), expected, 1e-13) << "friction " << mu;
    EXPECT_NEAR(v.dot(normal), 0, 1e-13);
    if (std::tan(theta) < mu) {
      EXPECT_LE(v.norm(), 1e-15);
    }
  }
}

/// A conveyor takes a particle along: v0 + nμgΔt until it sticks.
TEST(Collisions, Conveyor) {
  Scene scene = test::empty_scene();
  scene.gravity = Vec3(0, 0, -10);
  scene.flip = 1;
  scene.time.step = 1e-3;
  Collider belt = with_friction(0.5);
  belt.velocity = Vec3(1, 0, 0);
  scene.colliders = {belt};
  const Vec3 x(0.03, 0.04, -0.45);
  const double per_step = 0.5 * 10 * 1e-3;  // μgΔt
  for (const int n : {1, 10, 150})
    EXPECT_NEAR(PointParticle(scene).run(x, Vec3(0.2, 0, 0), n)[0], 0.2 + n * per_step, 1e-12);
  for (const int n : {160, 161, 200})  // ⌈(1 − 0.2)/0.005⌉ = 160
    EXPECT_NEAR(PointParticle(scene).run(x, Vec3(0.2, 0, 0), n)[0], 1, 1e-12);
}

TEST(Collisions, RotatingColliderCarriesItsNodesAround) {
  Scene scene = test::empty_scene();
  Collider disc = with_friction(0);
  disc.sticky = true;
  disc.shape = Sphere{Vec3(1, 2, 3), 10};
  disc.center = Vec3(1, 2, 3);
  disc.angular_velocity = Vec3(0, 0, 2);
  disc.velocity = Vec3(0.5, 0, 0);
  scene.colliders = {disc};
  Grid grid;
  grid.node = {{30, 20, 30}};  // x_i = (3, 2, 3)
  grid.m = {1};
  grid.v_star = {Vec3(9, 9, 9)};
  grid_collisions(scene, 1.0, grid);
  // At t = 1 the centre is at (1.5, 2, 3): v_co = (0.5, 0, 0) + 2 e_z × (1.5, 0, 0)
  EXPECT_LE((grid.v_star[0] - Vec3(0.5, 3, 0)).norm(), 20 * eps);
}

TEST(Collisions, SeveralCollidersInSceneOrder) {
  Scene scene = test::empty_scene();
  Collider left = with_friction(0), right = with_friction(0);
  left.shape = HalfSpace{Vec3(1, 0, 0), Vec3(1, 0, 0)};  // both hold the origin
  right.shape = HalfSpace{Vec3(1, 0, 0), Vec3(1, 0, 1)};
  Grid grid;
  grid.node = {{0, 0, 0}};
  grid.m = {1};
  const Vec3 v(-1, 0, 0);
  grid.v_star = {v};
  scene.colliders = {left, right};
  grid_collisions(scene, 0, grid);
  EXPECT_EQ(grid.v_star[0],
            Vec3(Vec3::Zero()));  // the first stops it, the second has nothing to do
  grid.v_star = {v};
  scene.colliders = {right, left};
  grid_collisions(scene, 0, grid);
  EXPECT_LE((grid.v_star[0] - Vec3(0, 0, 0.5)).norm(), 4 * eps);  // the first turns it upward
}

TEST(Collisions, FreeDirections) {
  Scene scene = test::empty_scene();
  scene.integrator.type = IntegratorType::semi_implicit;
  const auto directions = [&](const std::vector<Collider>& colliders, const Vec3& v) -> Mat3 {
    Scene s = scene;
    s.colliders = colliders;
    Grid grid;
    grid.node = {{0, 0, 0}};
    grid.m = {1};
    grid.v_star = {v};
    grid_collisions(s, 0, grid);
    return grid.free_directions[0];
  };
  const auto plane = [](const Vec3& normal, double mu) {
    Collider collider = with_friction(mu);
    collider.shape = HalfSpace{Vec3::Zero(), normal};
    return collider;
  };
  const Collider floor = plane(Vec3::UnitZ(), 0.1);
  EXPECT_EQ(directions({}, Vec3(1, 1, -1)), Mat3(Mat3::Identity()));
  EXPECT_EQ(directions({floor}, Vec3(1, 1, 1)), Mat3(Mat3::Identity()));             // separates
  EXPECT_EQ(directions({floor}, Vec3(0.1, 0, -9)), Mat3(Mat3::Zero()));              // sticks
  EXPECT_EQ(directions({floor}, Vec3(1, 1, -1)), Mat3(Vec3(1, 1, 0).asDiagonal()));  // slides
  // Two walls, not at right angles: only their common edge is free.
  const Mat3 edge = directions({plane(Vec3(1, 0, 0), 0), plane(Vec3(1, 1, 0), 0)}, Vec3(-1, -2, 1));
  EXPECT_LE((edge - Mat3(Vec3(0, 0, 1).asDiagonal())).norm(), 10 * eps);
  // The same wall twice takes one direction.
  const Mat3 twice = directions({plane(Vec3(1, 2, 3), 0), plane(Vec3(2, 4, 6), 0)}, Vec3(-1, 0, 0));
  EXPECT_NEAR(twice.trace(), 2, 10 * eps);
  // Explicit scenes do without.
  scene.integrator.type = IntegratorType::explicit_euler;
  Grid grid;
  grid.node = {{0, 0, 0}};
  grid.m = {1};
  grid.v_star = {Vec3(Vec3::Zero())};
  grid_collisions(scene, 0, grid);
  EXPECT_TRUE(grid.free_directions.empty());
}

/// Step 9 alone stops a particle whose nodes are all outside the collider: a ball
/// smaller than a cell.
TEST(Collisions, ParticlesMeetWhatTheGridCannotSee) {
  Scene scene = test::empty_scene();
  Collider ball = with_friction(0);
  ball.shape = Sphere{Vec3::Constant(0.05), 0.02};
  scene.colliders = {ball};
  State state = test::particles_at_rest(scene);
  state.particles.x[0] = Vec3(0.05, 0.05, 0.06);
  state.particles.v[0] = Vec3(1, 0, -1);
  state.particles.V_0[0] = 1e-3;
  auto solver = test::make_reference();
  solver->load(scene, state);
  solver->advance_through(Stage::particle_velocities, 1e-4);
  solver->store(state);
  EXPECT_LE((state.particles.v[0] - Vec3(1, 0, -1)).norm(), 1e-14);
  solver->advance_through(Stage::particle_collisions, 1e-4);
  solver->store(state);
  EXPECT_LE((state.particles.v[0] - Vec3(1, 0, 0)).norm(), 1e-14);
}

}  // namespace
}  // namespace firn::reference
