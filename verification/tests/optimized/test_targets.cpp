// SPDX-License-Identifier: BSD-3-Clause
// Every instruction set that the processor has is dispatched, and each passes
// lockstep against the reference.

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <gtest/gtest.h>

#include "firn/error.hpp"
#include "optimized/optimized_solver.hpp"
#include "optimized/target.hpp"
#include "solvers/solvers.hpp"
#include "verification/check/check.hpp"
#include "verification/oracles/processor.hpp"
#include "verification/tests/optimized/snow_scenes.hpp"

namespace firn::test {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

Scene semi_implicit(Scene scene) {
  scene.integrator = {IntegratorType::semi_implicit, 0.9, 1e-6, 1000};
  return scene;
}

class Targets : public testing::Test {
 protected:
  void TearDown() override { unsetenv("FIRN_TARGET"); }
};

TEST_F(Targets, EveryOneIsDispatchedAndValid) {
  const Scene scenes[] = {collision_of_everything(), periodic_snow(true), periodic_snow(false),
                          semi_implicit(collision_of_everything())};
  Registry registry;
  register_solvers(registry);
  const auto reference = registry.create("reference", {});
  int checked = 0;
  for (const std::string& target : optimized_targets()) {
    ASSERT_EQ(setenv("FIRN_TARGET", lower(target).c_str(), 1), 0);
    EXPECT_EQ(optimized_target_name(), target);
    for (const std::string& dispatched : optimized::dispatched_targets())
      EXPECT_EQ(dispatched, target);
    for (const Scene& scene : scenes)
      for (const Precision precision : {Precision::float64, Precision::float32}) {
        const auto solver = optimized(precision, 2);
        CheckOptions options;
        options.steps = 2;
        const CheckReport report =
            run_check(scene, advanced(scene, 30), *reference, *solver, options);
        EXPECT_TRUE(report.valid()) << target << "\n" << to_table(report);
        EXPECT_GT(report.compared(), 100000);
        ++checked;
      }
  }
  EXPECT_EQ(checked, 8 * static_cast<int>(optimized_targets().size()));
}

TEST_F(Targets, EverythingThatTheProcessorHasIsThere) {
  const std::vector<std::string> targets = optimized_targets();
  for (const std::string& name : verification::instruction_sets_of_the_processor())
    EXPECT_EQ(std::count(targets.begin(), targets.end(), name), 1) << name;
}

/// Every lane does the same operations in the same order on every instruction set,
/// and the four nodes in z are always added as (0+2) + (1+3). Only SSE4 differs: it
/// has no fused multiply-add.
TEST_F(Targets, FusedMultiplyAddMakesTheSameBitsEverywhere) {
  for (const Scene& scene : {collision_of_everything(), semi_implicit(collision_of_everything())})
    for (const Precision precision : {Precision::float64, Precision::float32}) {
      std::vector<State> states;
      for (const std::string& target : optimized_targets()) {
        if (target == "SSE4") continue;
        ASSERT_EQ(setenv("FIRN_TARGET", lower(target).c_str(), 1), 0);
        const auto solver = optimized(precision);
        State state = initial_state(scene);
        solver->load(scene, state);
        for (int n = 0; n < 24; ++n) solver->step(scene.time.step);
        solver->store(state);
        states.push_back(state);
      }
      for (const State& state : states) EXPECT_TRUE(same_bits(states.front(), state));
    }
}

/// A solver's memory is laid out for its instruction set: another solver that is made for
/// another one must not change it.
TEST_F(Targets, ASolverKeepsItsOwn) {
  Scene scene = semi_implicit(collision_of_everything());
  scene.time.step *= 4;
  for (const Precision precision : {Precision::float64, Precision::float32}) {
    std::vector<State> states;
    for (const bool meanwhile : {false, true}) {
      const std::string narrowest = lower(optimized_targets().back());
      ASSERT_EQ(setenv("FIRN_TARGET", narrowest.c_str(), 1), 0);
      const auto solver = optimized(precision);
      if (meanwhile) {
        ASSERT_EQ(unsetenv("FIRN_TARGET"), 0);
        optimized(precision);
      }
      State state = initial_state(scene);
      solver->load(scene, state);
      for (int n = 0; n < 4; ++n) solver->step(scene.time.step);
      solver->store(state);
      states.push_back(state);
    }
    EXPECT_TRUE(same_bits(states[0], states[1]));
  }
}

TEST_F(Targets, AnUnknownOneIsRefused) {
  ASSERT_EQ(setenv("FIRN_TARGET", "mmx", 1), 0);
  EXPECT_THROW(optimized(Precision::float32), InputError);
}

}  // namespace
}  // namespace firn::test
