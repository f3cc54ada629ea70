// SPDX-License-Identifier: BSD-3-Clause
// Failures, diagnostics, memory and precision of the optimized solver.

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "firn/error.hpp"
#include "verification/tests/optimized/allocations.hpp"
#include "verification/tests/optimized/snow_scenes.hpp"

namespace firn::test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class OptimizedSolver : public testing::TestWithParam<Precision> {};

struct Injection {
  const char* what;
  void (*into)(Particles&, std::size_t p);
  Stage stage;
};

/// A number that is not finite is found in the step in which it appears, with its
/// stage and particle, and before anything has changed.
TEST_P(OptimizedSolver, NamesTheParticleThatIsNotFinite) {
  const Injection injections[] = {
      {"v", [](Particles& q, std::size_t p) { q.v[p][1] = nan; }, Stage::rasterize},
      {"F_E", [](Particles& q, std::size_t p) { q.F_E[p](2, 0) = nan; }, Stage::grid_forces},
      {"F_P", [](Particles& q, std::size_t p) { q.F_P[p](1, 1) = nan; }, Stage::grid_forces},
      {"hardening", [](Particles& q, std::size_t p) { q.F_P[p] = -5.0 * Mat3::Identity(); },
       Stage::grid_forces}};
  const Scene scene = periodic_snow(true);
  State state = initial_state(scene);
  const std::size_t p = state.particles.size() / 3;
  // V_0 is known from the start: the step takes the fused path.
  for (double& V : state.particles.V_0) V = 1e-3 / 8;
  for (const Injection& injection : injections) {
    State broken = state;
    injection.into(broken.particles, p);
    const auto solver = optimized(GetParam(), 2);
    solver->load(scene, broken);
    try {
      solver->step(scene.time.step);
      ADD_FAILURE() << injection.what << ": nothing was thrown";
    } catch (const SimulationError& error) {
      EXPECT_EQ(error.stage(), injection.stage) << injection.what << ": " << error.what();
      EXPECT_EQ(error.subject(), SimulationError::Subject::particle) << injection.what;
      EXPECT_EQ(error.index(), static_cast<std::int64_t>(p)) << injection.what;
      EXPECT_TRUE(error.state_intact) << injection.what;
    }
  }
}

TEST_P(OptimizedSolver, APositionThatIsNotFiniteOrTooFarIsRefused) {
  const Scene scene = collision_of_everything();
  for (const double x : {nan, 1e9}) {
    State state = initial_state(scene);
    state.particles.x[7][2] = x;
    try {
      const auto solver = optimized(GetParam());
      solver->load(scene, state);
      ADD_FAILURE() << "nothing was thrown";
    } catch (const SimulationError& error) {
      EXPECT_EQ(error.index(), 7);
    }
  }
}

/// A solver that is given a state between two stages ends the step as the one that began it, and
/// so the next one.
TEST_P(OptimizedSolver, AnotherSolverGoesOnBetweenAnyTwoStages) {
  const Scene scene = collision_of_everything();
  for (const Stage last : all_stages) {
    if (last == Stage::positions) continue;
    const auto first = optimized(GetParam()), second = optimized(GetParam());
    State state = initial_state(scene), expected, found;
    first->load(scene, state);
    for (int n = 0; n < 20; ++n) first->step(scene.time.step);
    first->advance_through(last, scene.time.step);
    first->store(state);
    second->load(scene, state);
    for (Solver* solver : {first.get(), second.get()}) {
      solver->advance_through(Stage::positions, scene.time.step);
      solver->step(scene.time.step);
    }
    first->store(expected);
    second->store(found);
    // The second solver sorts its particles anew and adds in another order: 1 eps was measured, and
    // sums of a hundred particles may differ by a hundred. A step without stress is 1e-2 m/s off.
    const double eps = GetParam() == Precision::float64 ? 2.2e-16 : 1.2e-7;
    double speed = 0, difference = 0;
    for (std::size_t p = 0; p < state.particles.size(); ++p) {
      speed = std::max(speed, expected.particles.v[p].norm());
      difference = std::max(difference, (found.particles.v[p] - expected.particles.v[p]).norm());
    }
    EXPECT_LE(difference, 100 * eps * speed) << name(last);
  }
}

/// Four cells in a step: the particle is named, the state is gone and it says so.
TEST_P(OptimizedSolver, AParticleTooFastIsNamed) {
  Scene scene = collision_of_everything();
  State state = initial_state(scene);
  for (double& V : state.particles.V_0) V = 1e-5;
  for (Vec3& v : state.particles.v) v = Vec3(0, 0, 5 * scene.grid.spacing / scene.time.step);
  const auto solver = optimized(GetParam());
  solver->load(scene, state);
  try {
    solver->step(scene.time.step);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const SimulationError& error) {
    EXPECT_EQ(error.stage(), Stage::positions);
    EXPECT_FALSE(error.state_intact);
  }
}

TEST_P(OptimizedSolver, DiagnosticsAgreeWithThePlainSums) {
  const Scene scene = collision_of_everything();
  const auto solver = optimized(GetParam(), 2);
  State state = initial_state(scene);
  solver->load(scene, state);
  for (int n = 0; n < 20; ++n) solver->step(scene.time.step);
  solver->store(state);
  const Diagnostics fast = solver->diagnostics(scene), plain = measure(scene, state);
  // The energy of a particle comes from its stress, at the solver's roundoff; the sums
  // are in double. 100 eps covers the 40-odd operations in between.
  const double eps = GetParam() == Precision::float64 ? 2.2e-16 : 1.2e-7;
  EXPECT_NEAR(fast.elastic_energy, plain.elastic_energy, 100 * eps * plain.elastic_energy);
  EXPECT_GT(plain.elastic_energy, 0);
  // Sums of 3000 terms in another order.
  const double sum = 3000 * 2.2e-16;
  EXPECT_NEAR(fast.mass, plain.mass, sum * plain.mass);
  EXPECT_NEAR(fast.kinetic_energy, plain.kinetic_energy, sum * plain.kinetic_energy);
  const double p_scale = plain.mass * plain.max_speed;
  EXPECT_LE((fast.momentum - plain.momentum).norm(), sum * p_scale);
  EXPECT_LE((fast.angular_momentum - plain.angular_momentum).norm(), sum * p_scale);
  EXPECT_LE((fast.center_of_mass - plain.center_of_mass).norm(), sum);
  EXPECT_DOUBLE_EQ(fast.max_speed, plain.max_speed);
  EXPECT_NEAR(fast.min_J_E, plain.min_J_E, 8 * eps);
  EXPECT_NEAR(fast.max_J_E, plain.max_J_E, 8 * eps);
}

/// Snow that flows through a periodic box changes blocks all the time; after some
/// steps every list has found its length.
TEST_P(OptimizedSolver, ASteadyStepAllocatesNothing) {
  const Scene scene = periodic_snow(true);
  const auto solver = optimized(GetParam(), 2);
  State state = initial_state(scene);
  solver->load(scene, state);
  for (int n = 0; n < 400; ++n) solver->step(scene.time.step);
  const long before = allocations;
  for (int n = 0; n < 20; ++n) solver->step(scene.time.step);
  EXPECT_EQ(allocations - before, 0);
  EXPECT_GT(before, 0) << "the counter is not in use";
}

/// The same with a solve in every step, nodes held by a collider among them.
TEST_P(OptimizedSolver, ASteadySolveAllocatesNothing) {
  Scene scene = periodic_snow(true);
  scene.integrator = {IntegratorType::semi_implicit, 1.0, 1e-5, 1000};
  scene.time.step *= 8;
  const auto solver = optimized(GetParam(), 2);
  solver->load(scene, initial_state(scene));
  for (int n = 0; n < 60; ++n) solver->step(scene.time.step);
  const long before = allocations;
  std::int64_t iterations = 0;
  for (int n = 0; n < 20; ++n) iterations += solver->step(scene.time.step).solver_iterations;
  EXPECT_EQ(allocations - before, 0);
  EXPECT_GE(iterations, 40) << "nothing was solved";
}

/// Beyond an explicit run: 14 numbers per particle, and m, vⁿ and v* of the nodes, of which a
/// block of 12³ cells has one for 2.5 particles. The vectors of the solve lie in the memory
/// of the tiles and its spare room.
TEST_P(OptimizedSolver, ASolveTakesLittleMemory) {
  Scene scene;
  scene.grid.spacing = 0.1;
  scene.materials = {Material{}};
  scene.time.step = 4e-4;
  Body body;
  body.shape = Box{Vec3(0, 0, 0), Vec3(1.2, 1.2, 1.2)};
  body.volumes = VolumeSource::exact;
  scene.bodies = {body};
  Collider floor;
  floor.shape = HalfSpace{Vec3(0, 0, 0.15), Vec3(0, 0, 1)};
  scene.colliders = {floor};
  const State state = initial_state(scene);
  const auto bytes = [&](IntegratorType type) {
    scene.integrator = {type, 1.0, 1e-3, 1000};
    const auto solver = optimized(GetParam());
    solver->load(scene, state);
    for (int n = 0; n < 2; ++n) solver->step(scene.time.step);
    return solver->bytes_per_particle();
  };
  const double more = bytes(IntegratorType::semi_implicit) - bytes(IntegratorType::explicit_euler);
  const double value = GetParam() == Precision::float64 ? 8 : 4;
  // 14 + 7/2.5 numbers, and a tenth for spare room, lanes left over and the lists of blocks; with
  // rows of one channel (SSE4) a tile has 7 instead of 8 and less room for the vectors: a
  // twentieth.
  EXPECT_LE(more, 1.15 * (14 + 7 / 2.5) * value);
  EXPECT_GT(more, 14 * value);
}

/// Whole cells away from the origin the same numbers come out, in float as in double:
/// positions are kept relative to a block.
TEST_P(OptimizedSolver, FarFromTheOriginNothingIsLost) {
  Scene scene = collision_of_everything();
  scene.colliders.clear();
  // Spacing and distance are powers of two, so that the shift itself is exact.
  scene.grid.spacing = 0x1p-5;
  State near = initial_state(scene), far = near;
  const Vec3 shift(0x1p15, -0x1p14, 0x1p15);  // a million cells
  for (State* state : {&near, &far})
    for (Vec3& x : state->particles.x)
      for (int axis = 0; axis < 3; ++axis) x[axis] = std::round(x[axis] * 0x1p30) * 0x1p-30;
  for (Vec3& x : far.particles.x) x += shift;
  for (State* state : {&near, &far}) {
    const auto solver = optimized(GetParam());
    solver->load(scene, *state);
    for (int n = 0; n < 10; ++n) solver->step(scene.time.step);
    solver->store(*state);
  }
  for (std::size_t p = 0; p < near.particles.size(); ++p) {
    EXPECT_EQ(near.particles.v[p], far.particles.v[p]);
    EXPECT_EQ(near.particles.F_E[p], far.particles.F_E[p]);
    if (HasFailure()) break;
  }
}

/// x = 1, v = 1e-3, Δt = 1e-5: a float position never moves. Here it does.
TEST_P(OptimizedSolver, SlowParticlesMove) {
  Scene scene = collision_of_everything();
  scene.colliders.clear();
  scene.gravity.setZero();
  scene.time.step = 1e-5;
  scene.bodies.resize(1);
  scene.bodies[0].velocity = Vec3(1e-3, 0, 0);
  scene.bodies[0].angular_velocity.setZero();
  State state = initial_state(scene);
  for (Vec3& x : state.particles.x) x[0] += 1;
  const State start = state;
  const auto solver = optimized(GetParam());
  solver->load(scene, state);
  for (int n = 0; n < 100; ++n) solver->step(1e-5);
  solver->store(state);
  // Each step rounds to 2^-28 h; the displacement of a step is 2e-7 h or 54 of them.
  for (std::size_t p = 0; p < state.particles.size(); ++p)
    EXPECT_NEAR(state.particles.x[p][0] - start.particles.x[p][0], 1e-6, 1e-6 / 54);
}

TEST_P(OptimizedSolver, NoParticlesAreNoTrouble) {
  Scene scene = collision_of_everything();
  scene.bodies.clear();
  const auto solver = optimized(GetParam(), 3);
  State state;
  solver->load(scene, state);
  EXPECT_EQ(solver->step(scene.time.step).grid_nodes, 0);
  solver->store(state);
  EXPECT_EQ(state.step, 1);
}

INSTANTIATE_TEST_SUITE_P(Precisions, OptimizedSolver,
                         testing::Values(Precision::float64, Precision::float32),
                         [](const auto& info) { return std::string(name(info.param)) + "_"; });

}  // namespace
}  // namespace firn::test
