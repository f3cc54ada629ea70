// SPDX-License-Identifier: BSD-3-Clause
// The same input gives the same bits: at any number of threads, by step() as by
// its stages, and across an interruption.

#include <cstddef>
#include <gtest/gtest.h>
#include <vector>

#include "firn/error.hpp"
#include "verification/tests/optimized/snow_scenes.hpp"

namespace firn::test {
namespace {

constexpr int steps = 24;  // both snowballs yield, cross block borders and touch everything

State run(const Scene& scene, Precision precision, int threads) {
  const auto solver = optimized(precision, threads);
  State state = initial_state(scene);
  solver->load(scene, state);
  for (int n = 0; n < steps; ++n) solver->step(scene.time.step);
  solver->store(state);
  return state;
}

/// The same in steps of several times the explicit limit.
Scene implicit(Scene scene) {
  scene.integrator = {IntegratorType::semi_implicit, 0.9, 1e-6, 1000};
  scene.time.step *= 4;
  return scene;
}

class Determinism : public testing::TestWithParam<Precision> {};

TEST_P(Determinism, ThreadsDoNotMatter) {
  for (const Scene& scene : {collision_of_everything(), periodic_snow(false),
                             implicit(collision_of_everything()), implicit(periodic_snow(false))}) {
    const State one = run(scene, GetParam(), 1);
    for (const int threads : {2, 3, 8})
      EXPECT_TRUE(same_bits(one, run(scene, GetParam(), threads))) << threads << " threads";
  }
}

TEST_P(Determinism, StepEqualsItsStages) {
  for (const Scene& scene : {collision_of_everything(), periodic_snow(true),
                             implicit(collision_of_everything()), implicit(periodic_snow(false))}) {
    const State whole = run(scene, GetParam(), 2);
    const auto solver = optimized(GetParam(), 1);
    State state = initial_state(scene);
    solver->load(scene, state);
    for (int n = 0; n < steps; ++n)
      for (const Stage stage : all_stages) solver->advance_through(stage, scene.time.step);
    solver->store(state);
    EXPECT_TRUE(same_bits(whole, state));
  }
}

/// Stop after step 11 (between two sorts of most blocks), go on from what was stored.
TEST_P(Determinism, InterruptionDoesNotMatter) {
  for (const Scene& scene : {collision_of_everything(), periodic_snow(false),
                             implicit(collision_of_everything()), implicit(periodic_snow(false))}) {
    const State whole = run(scene, GetParam(), 1);
    const auto first = optimized(GetParam());
    State state = initial_state(scene);
    first->load(scene, state);
    for (int n = 0; n < 11; ++n) first->step(scene.time.step);
    first->store(state);
    std::vector<std::byte> rest(first->restart_size());
    first->store_restart(rest);

    const auto second = optimized(GetParam(), 2);
    second->load(scene, state);
    second->load_restart(rest);
    for (int n = 11; n < steps; ++n) second->step(scene.time.step);
    second->store(state);
    EXPECT_TRUE(same_bits(whole, state));
  }
}

/// What the solver did before has no influence.
TEST_P(Determinism, ASecondLoadStartsAfresh) {
  const Scene scene = collision_of_everything(), other = periodic_snow(true);
  const State whole = run(scene, GetParam(), 1);
  const auto solver = optimized(GetParam());
  State state = initial_state(other);
  solver->load(other, state);
  for (int n = 0; n < 5; ++n) solver->step(other.time.step);
  state = initial_state(scene);
  solver->load(scene, state);
  for (int n = 0; n < steps; ++n) solver->step(scene.time.step);
  solver->store(state);
  EXPECT_TRUE(same_bits(whole, state));
}

TEST_P(Determinism, AFailedSolveIsNotReportedAfterAnotherLoad) {
  Scene hasty = implicit(collision_of_everything());
  hasty.time.step *= 4;
  hasty.integrator.tolerance = 1e-12, hasty.integrator.max_iterations = 3;
  const auto solver = optimized(GetParam());
  State state = initial_state(hasty);
  for (double& V : state.particles.V_0) V = 1e-5;  // known: step() is not taken in stages
  solver->load(hasty, state);
  EXPECT_THROW(solver->step(hasty.time.step), SimulationError);
  const Scene scene = collision_of_everything();
  solver->load(scene, state);
  const StepReport report = solver->step(scene.time.step);
  EXPECT_EQ(report.solver_iterations, 0);
  EXPECT_EQ(report.solver_residual, 0);
}

INSTANTIATE_TEST_SUITE_P(Precisions, Determinism,
                         testing::Values(Precision::float64, Precision::float32),
                         [](const auto& info) { return std::string(name(info.param)) + "_"; });

}  // namespace
}  // namespace firn::test
