// SPDX-License-Identifier: BSD-3-Clause
/// One mistake in one stage each: the check must be INVALID and name the stage.

#include <algorithm>
#include <gtest/gtest.h>
#include <stdexcept>

#include "firn/error.hpp"
#include "verification/check/check.hpp"
#include "verification/support/snow_cases.hpp"
#include "verification/tests/check/mistakes.hpp"

namespace firn::test {
namespace {

CheckReport check(const fixtures::Case& c, Solver& subject, CheckOptions options = {.steps = 2}) {
  const auto reference = make_reference();
  return run_check(c.scene, c.state, *reference, subject, options);
}

class Planted : public testing::TestWithParam<PlantedMistake> {};

TEST_P(Planted, IsFoundInItsStage) {
  const PlantedMistake& mistake = GetParam();
  // Also with the wider bounds of float: all of these are far above its roundoff.
  for (const Precision precision : {Precision::float64, Precision::float32}) {
    Mistaken subject(mistake.stage, mistake.apply, {}, precision);
    const CheckReport report = check(fixtures::lump_on_slope(), subject);
    ASSERT_FALSE(report.valid()) << to_table(report);
    const Divergence& first = *report.first_divergence;
    EXPECT_EQ(first.step, 0);
    EXPECT_EQ(first.from, mistake.stage) << first.message;
    EXPECT_EQ(first.through, mistake.stage) << first.message;
    ASSERT_TRUE(first.field.has_value()) << first.message;
    EXPECT_EQ(*first.field, mistake.field) << first.message;
    // The stages before it and after it, which start from the reference's state, are right.
    for (const FieldCheck& row : report.fields) {
      const bool whole_step = row.from != row.through;
      EXPECT_TRUE(row.valid || whole_step || row.from == mistake.stage)
          << stage_range(row.from, row.through);
    }
  }
}

TEST_P(Planted, IsFoundInWholeStepsOnly) {
  Mistaken subject(GetParam().stage, GetParam().apply, {Stage::positions});
  const CheckReport report = check(fixtures::lump_on_slope(), subject);
  ASSERT_FALSE(report.valid());
  EXPECT_EQ(report.first_divergence->from, Stage::rasterize);
  EXPECT_EQ(report.first_divergence->through, Stage::positions);
}

TEST_P(Planted, IsFoundWithinTheStretchBetweenTwoStops) {
  const std::vector<Stage> stops = {Stage::volumes, Stage::grid_velocities, Stage::integration,
                                    Stage::positions};
  Mistaken subject(GetParam().stage, GetParam().apply, stops);
  const CheckReport report = check(fixtures::lump_on_slope(), subject);
  ASSERT_FALSE(report.valid());
  const Divergence& first = *report.first_divergence;
  EXPECT_LE(first.from, GetParam().stage);
  EXPECT_GE(first.through, GetParam().stage);
  EXPECT_EQ(first.through, *std::lower_bound(stops.begin(), stops.end(), GetParam().stage));
}

TEST_P(Planted, IsFoundWhenRunningFreely) {
  Mistaken subject(GetParam().stage, GetParam().apply);
  const CheckReport report =
      check(fixtures::lump_on_slope(), subject, {.mode = CheckMode::free_running, .steps = 10});
  EXPECT_FALSE(report.valid()) << to_table(report);
}

INSTANTIATE_TEST_SUITE_P(Mistakes, Planted, testing::ValuesIn(planted_mistakes()),
                         [](const auto& info) { return info.param.name; });

/// Faults that no field shows: each in every stage.
class Fault : public testing::TestWithParam<Stage> {};

TEST_P(Fault, AnExceptionIsTheSubjectsAndNamesTheStage) {
  Mistaken subject(GetParam(), [](const StageRun&) { throw std::runtime_error("out of luck"); });
  const CheckReport report = check(fixtures::lump_on_slope(), subject);
  ASSERT_FALSE(report.valid());
  EXPECT_EQ(report.first_divergence->through, GetParam());
  EXPECT_NE(report.first_divergence->message.find("out of luck"), std::string::npos);
}

TEST_P(Fault, SomethingThrownThatIsNoException) {
  Mistaken subject(GetParam(), [](const StageRun&) { throw 42; });
  const CheckReport report = check(fixtures::lump_on_slope(), subject);
  ASSERT_FALSE(report.valid());
  EXPECT_EQ(report.first_divergence->through, GetParam());
}

TEST_P(Fault, ALostParticle) {
  Mistaken subject(GetParam(), [](const StageRun& run) { run.after.particles.v.pop_back(); });
  const CheckReport report = check(fixtures::lump_on_slope(), subject);
  ASSERT_FALSE(report.valid());
  EXPECT_EQ(report.first_divergence->through, GetParam());
  EXPECT_NE(report.first_divergence->message.find("v holds 259 entries for 260 particles"),
            std::string::npos);
}

TEST_P(Fault, AFieldThatTheStageHasNoBusinessWith) {
  // v_p before stage 8, F_P after stage 7: what the stage does not write must stay.
  const bool late = GetParam() >= Stage::particle_velocities;
  Mistaken subject(GetParam(), [late](const StageRun& run) {
    if (late)
      run.after.particles.F_P[5](0, 1) += 1e-9;
    else
      run.after.particles.v[5][0] += 1e-9;
  });
  const CheckReport report = check(fixtures::lump_on_slope(), subject);
  ASSERT_FALSE(report.valid());
  EXPECT_EQ(report.first_divergence->through, GetParam());
  EXPECT_EQ(*report.first_divergence->field, late ? Field::particle_F_P : Field::particle_velocity);
}

TEST_P(Fault, ParticlesInAnotherOrder) {
  Mistaken subject(GetParam(), [](const StageRun& run) {
    std::swap(run.after.particles.id[0], run.after.particles.id[1]);
    std::swap(run.after.particles.x[0], run.after.particles.x[1]);
  });
  const CheckReport report = check(fixtures::lump_on_slope(), subject);
  ASSERT_FALSE(report.valid());
  EXPECT_EQ(report.first_divergence->through, GetParam());
}

TEST_P(Fault, ASolverThatStaysWhereItWas) {
  Mistaken subject(GetParam(), [](const StageRun& run) { run.after = run.before; });
  const CheckReport report = check(fixtures::lump_on_slope(), subject);
  ASSERT_FALSE(report.valid());
  EXPECT_EQ(report.first_divergence->through, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Stages, Fault, testing::ValuesIn(all_stages),
                         [](const auto& info) { return std::string(name(info.param)); });

TEST(Faults, UnsortedNodesAndMissingNodes) {
  Mistaken unsorted(Stage::grid_forces, [](const StageRun& run) {
    std::swap(run.after.grid.node[0], run.after.grid.node[1]);
  });
  const CheckReport first = check(fixtures::lump_on_slope(), unsorted);
  ASSERT_FALSE(first.valid());
  EXPECT_EQ(first.first_divergence->through, Stage::grid_forces);

  // A heavy node that vanishes counts as zero against what the reference has there.
  Mistaken missing(Stage::rasterize, [](const StageRun& run) {
    Grid& grid = run.after.grid;
    const auto heaviest = std::max_element(grid.m.begin(), grid.m.end()) - grid.m.begin();
    grid.node.erase(grid.node.begin() + heaviest);
    grid.m.erase(grid.m.begin() + heaviest);
    grid.v.erase(grid.v.begin() + heaviest);
  });
  const CheckReport second = check(fixtures::lump_on_slope(), missing);
  ASSERT_FALSE(second.valid());
  EXPECT_EQ(second.first_divergence->through, Stage::rasterize);
  EXPECT_EQ(*second.first_divergence->field, Field::node_mass);
}

TEST(Faults, ANodeOutOfNowhere) {
  Mistaken subject(Stage::rasterize, [](const StageRun& run) {
    Grid& grid = run.after.grid;
    NodeIndex beyond = grid.node.back();
    beyond.i += 5;
    grid.node.push_back(beyond);
    grid.m.push_back(1e-12);
    grid.v.push_back(Vec3::Zero());
  });
  const CheckReport report = check(fixtures::lump_on_slope(), subject);
  ASSERT_FALSE(report.valid());
  EXPECT_EQ(report.first_divergence->through, Stage::rasterize);
}

/// Stage 6 of the reference in a scene or from a state that `change` has altered.
Mistake other_solve(std::function<void(Scene&, State&)> change) {
  return [=](const StageRun& run) {
    Scene scene = run.scene;
    State input = run.before, output;
    change(scene, input);
    const auto solver = make_reference();
    solver->load(scene, input);
    solver->advance_through(Stage::integration, run.dt);
    solver->store(output);
    run.after.grid.v_new = output.grid.v_new;
  };
}

TEST(ImplicitSolve, ItsOwnMistakesAreFoundInStage6) {
  const struct {
    const char* name;
    Mistake mistake;
    const char* message;
  } planted[] = {
      {"stopped at once", [](const StageRun& run) { run.after.grid.v_new = run.after.grid.v_star; },
       "solves the semi-implicit system"},
      {"stopped early",
       other_solve([](Scene& scene, State&) { scene.integrator.tolerance = 1e-2; }),
       "solves the semi-implicit system"},
      {"half the implicitness",
       other_solve([](Scene& scene, State&) { scene.integrator.implicitness = 0.5; }),
       "solves the semi-implicit system"},
      {"no stress in the operator", other_solve([](Scene&, State& state) {
         for (Mat3& F_E : state.particles.F_E) F_E.setIdentity();
       }),
       "solves the semi-implicit system"},
      {"contact not held", other_solve([](Scene&, State& state) {
         for (Mat3& free : state.grid.free_directions) free.setIdentity();
       }),
       "moves no node against its contact"},
  };
  for (const auto& plant : planted) {
    SCOPED_TRACE(plant.name);
    Mistaken subject(Stage::integration, plant.mistake);
    const CheckReport report = check(fixtures::implicit_lump(), subject, {.steps = 1});
    ASSERT_FALSE(report.valid()) << to_table(report);
    EXPECT_EQ(report.first_divergence->from, Stage::integration);
    EXPECT_EQ(report.first_divergence->through, Stage::integration);
    bool told = false;
    for (const PropertyCheck& property : report.properties)
      told = told || (!property.valid && property.name.find(plant.message) != std::string::npos);
    EXPECT_TRUE(told) << to_table(report);
  }
}

TEST(Faults, PositionsThatAreNotWrapped) {
  Mistaken subject(Stage::positions, [](const StageRun& run) {
    for (Vec3& x : run.after.particles.x) x[0] += run.scene.grid.periodic[0];
  });
  const CheckReport report = check(fixtures::periodic_lump(), subject);
  ASSERT_FALSE(report.valid());
  EXPECT_EQ(report.first_divergence->through, Stage::positions);
}

/// step() is a path of its own in a fused solver.
class FusedDiffers final : public Mistaken {
 public:
  FusedDiffers() : Mistaken(Stage::positions, {}) {}
  StepReport step(double dt) override {
    const StepReport report = Mistaken::step(dt);
    state_.particles.v[7][2] *= 1 + 2.3e-16;  // one bit, far within every bound
    return report;
  }
};

TEST(Faults, AFusedStepThatDiffersInOneBit) {
  FusedDiffers subject;
  const CheckReport report = check(fixtures::lump_on_slope(), subject);
  ASSERT_FALSE(report.valid());
  EXPECT_NE(report.first_divergence->message.find("step() equals its stages bit for bit"),
            std::string::npos);
  for (const FieldCheck& row : report.fields) EXPECT_TRUE(row.valid);
}

TEST(Faults, WhatCannotBeCheckedIsBadInput) {
  const fixtures::Case c = fixtures::lump_on_slope();
  const auto reference = make_reference(), subject = make_reference();
  EXPECT_THROW(run_check(c.scene, c.state, *reference, *subject, {.steps = 0}), InputError);
  EXPECT_THROW(run_check(c.scene, c.state, *reference, *subject, {.steps = 1, .start_step = -1}),
               InputError);
  Mistaken one_stop(Stage::positions, {}, {Stage::positions});
  EXPECT_THROW(run_check(c.scene, c.state, one_stop, *subject, {}), InputError);
}

}  // namespace
}  // namespace firn::test
