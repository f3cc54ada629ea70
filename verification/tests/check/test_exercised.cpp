// SPDX-License-Identifier: BSD-3-Clause
/// What a check says to have exercised, and the steps that it chooses.

#include <algorithm>
#include <gtest/gtest.h>
#include <sstream>

#include "firn/error.hpp"
#include "firn/scene_hash.hpp"
#include "io/scene/scene_file.hpp"
#include "verification/check/check_set.hpp"
#include "verification/check/error_map.hpp"
#include "verification/check/windows.hpp"
#include "verification/support/builtin_registry.hpp"
#include "verification/support/snow_cases.hpp"

namespace firn {
namespace {

using fixtures::builtin_registry;
using fixtures::make_reference;

CheckReport check_of(const Scene& scene, const CheckOptions& options) {
  return run_check(scene, *make_reference(), *make_reference(), options);
}

TEST(Exercised, AFallingBallNeitherYieldsNorTouches) {
  const CheckReport report = check_of(find_scene("tiny_impact"), {.steps = 2});
  EXPECT_TRUE(report.valid());
  EXPECT_EQ(report.not_exercised, (std::vector<std::string>{"plastic", "contact"}));
  EXPECT_EQ(report.exercised[Feature::volume_estimated], 527);
  EXPECT_EQ(report.exercised[Feature::elastic], 2 * 527);
  EXPECT_NE(verdict_line(report).find("; not exercised: plastic flow, contact"), std::string::npos);
}

TEST(Exercised, AnImpactDoesBoth) {
  const CheckReport report = check_of(find_scene("tiny_impact"), {.steps = 1, .start_step = 150});
  const Exercised& e = report.exercised;
  EXPECT_GT(e[Feature::yields_in_stretch] + e[Feature::yields_in_compression] +
                e[Feature::yields_in_both],
            0);
  EXPECT_GT(e[Feature::node_slides], 0);
  EXPECT_EQ(e[Feature::friction], e[Feature::node_slides] + e[Feature::particle_slides]);
  EXPECT_EQ(e[Feature::volume_estimated], 0);
  EXPECT_EQ(e[Feature::yields_in_both] + e[Feature::yields_in_stretch] +
                e[Feature::yields_in_compression] + e[Feature::elastic],
            527);
}

/// Both modes count the same: the reference's own states.
TEST(Exercised, RunningFreelyCountsTheSame) {
  const Scene scene = find_scene("tiny_impact");
  CheckOptions options{.steps = 3, .start_step = 100};
  const CheckReport lockstep = check_of(scene, options);
  options.mode = CheckMode::free_running;
  const CheckReport free = check_of(scene, options);
  for (const FeatureName& name : feature_names())
    EXPECT_EQ(lockstep.exercised[name.feature], free.exercised[name.feature]) << name.key;
}

/// One particle of each kind, placed by hand.
TEST(Exercised, PlacesAndStrainsAreToldApart) {
  Scene scene;
  scene.grid.spacing = 0.5;
  scene.grid.periodic = {4, 0, 0};
  scene.materials = {Material{}, Material{}};
  State before, after;
  Particles& p = before.particles;
  p.resize(5);
  p.m = {1, 1, 1, 1, 1};
  p.x = {Vec3(2, 1, 1), Vec3(2.1, 1, 1.2), Vec3(0.1, 1.1, 1.2), Vec3(2.1, 1.1, 1.2),
         Vec3(3.9, 1.3, 1.3)};
  p.F_E[1] = -Mat3::Identity();
  p.F_E[2] = Vec3(1, 1, 1e-5).asDiagonal();
  p.F_P[3] *= 1.1;
  p.F_P[4] *= 0.9;
  p.material = {0, 0, 0, 0, 0};
  after = before;
  after.grid.node = {{0, 0, 0}, {1, 0, 0}};
  after.grid.m = {1e-7, 0.5};
  Exercised e;
  e.add(scene, Stage::rasterize, before, after, {});
  e.add(scene, Stage::volumes, before, after, {});
  e.add(scene, Stage::grid_forces, before, after, {});
  EXPECT_EQ(e[Feature::on_node], 1);
  EXPECT_EQ(e[Feature::on_face], 1);
  EXPECT_EQ(e[Feature::across_seam], 2);
  EXPECT_EQ(e[Feature::light_node], 1);
  EXPECT_EQ(e[Feature::several_materials], 0);
  EXPECT_EQ(e[Feature::volume_estimated], 5);
  EXPECT_EQ(e[Feature::inverted], 1);
  EXPECT_EQ(e[Feature::degenerate], 1);
  EXPECT_EQ(e[Feature::expanded], 1);
  EXPECT_EQ(e[Feature::compressed], 1);
  after.particles.x[4][0] = 0.1;
  e.add(scene, Stage::positions, before, after, {});
  EXPECT_EQ(e[Feature::crosses_seam], 1);
}

TEST(Exercised, SeveralMaterialsMeetAtNodes) {
  const fixtures::Case c = fixtures::lump_on_slope();
  const CheckReport report =
      run_check(c.scene, c.state, *make_reference(), *make_reference(), {.steps = 1});
  EXPECT_GT(report.exercised[Feature::several_materials], 0);
  EXPECT_GT(report.exercised[Feature::node_several], 0);
  EXPECT_GT(report.exercised[Feature::turning], 0);
  EXPECT_GT(report.exercised[Feature::sticky], 0);
}

TEST(Exercised, AnUnknownRequirementIsInvalidInput) {
  EXPECT_EQ(std::string(requirement_of("plastic").phrase), "plastic flow");
  EXPECT_THROW(requirement_of("snow"), InputError);
}

/// Nothing compared is no VALID.
TEST(Exercised, AnEmptyReportIsIncomplete) {
  EXPECT_EQ(verdict_word(CheckReport{}), "INCOMPLETE");
  EXPECT_EQ(verdict_word(CheckSet{}), "INCOMPLETE");
}

TEST(Exercised, AnInterruptedCheckIsIncomplete) {
  CheckOptions options{.steps = 3};
  options.progress = [](std::int64_t done) { return done < 2; };
  const CheckReport report = check_of(find_scene("two_particles"), options);
  EXPECT_TRUE(report.interrupted);
  EXPECT_EQ(report.steps, 2);
  EXPECT_EQ(verdict_word(report), "INCOMPLETE");
  options.progress = [](std::int64_t done) { return done < 3; };  // too late to interrupt
  EXPECT_EQ(verdict_word(check_of(find_scene("two_particles"), options)), "VALID");
}

Sighting sighting(std::int64_t step, TimeStepBound bound) {
  Sighting s{step, {}};
  s.exercised.add_step(bound);
  return s;
}

TEST(Windows, StepsCoverEveryFeatureThatWasSeen) {
  const std::vector<Sighting> seen = {
      sighting(0, TimeStepBound::fixed), sighting(1, TimeStepBound::fixed),
      sighting(2, TimeStepBound::cfl), sighting(3, TimeStepBound::fixed),
      sighting(4, TimeStepBound::max_step)};
  EXPECT_EQ(choose_steps(seen, 3), (std::vector<std::int64_t>{0, 2, 4}));
  EXPECT_EQ(choose_steps(seen, 2).size(), 2u);
  EXPECT_EQ(choose_steps(seen, 9), (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
}

TEST(Windows, AWholeSceneIsLookedThrough) {
  const Scene scene = find_scene("tiny_impact");
  const auto scout = builtin_registry().create("optimized", {});
  WindowOptions options;
  options.steps = 4;
  const WindowPlan plan = plan_windows(scene, initial_state(scene), *scout, options);
  EXPECT_TRUE(plan.complete);
  EXPECT_EQ(plan.passed, 300);
  ASSERT_EQ(plan.windows.size(), 4u);
  const CheckReport report = run_check(scene, plan.windows, *make_reference(),
                                       *builtin_registry().create("optimized", {}));
  EXPECT_TRUE(report.valid()) << to_table(report);
  for (const Requirement& requirement : requirements())
    EXPECT_EQ(met(requirement, report.exercised), met(requirement, plan.seen)) << requirement.key;
}

/// Errors of all particles and nodes in the stage that is wrong, none in the stages before it.
TEST(ErrorMap, HasTheErrorsOfEveryPoint) {
  const Scene scene = find_scene("tiny_impact");
  ErrorMap map;
  CheckOptions options{.steps = 2, .start_step = 150};
  options.error_map = &map;
  const CheckReport report = run_check(
      scene, *make_reference(), *builtin_registry().create("mutant:force_sign", {}), options);
  EXPECT_FALSE(report.valid());
  ASSERT_EQ(map.frames().size(), 2u);
  const ErrorFrame& frame = map.frames().front();
  EXPECT_EQ(frame.step, 150);
  EXPECT_EQ(std::count(frame.id.begin(), frame.id.end(), -1),
            static_cast<std::ptrdiff_t>(frame.point.size()) - 527);
  for (const ErrorColumn& column : frame.columns) {
    ASSERT_EQ(column.in_bounds.size(), frame.point.size()) << column.name;
    const auto wrong = std::count_if(column.in_bounds.begin(), column.in_bounds.end(),
                                     [](float error) { return error > 1; });
    if (column.name == "1_rasterize m_i") {
      EXPECT_EQ(wrong, 0);
    } else if (column.name == "3_grid_forces f_i") {
      EXPECT_EQ(wrong, static_cast<std::ptrdiff_t>(frame.point.size()) - 527);
    }
  }
}

TEST(SceneHash, IsThatOfTheReports) {
  const std::string text = "[grid]\nspacing = 1\n[time]\nend = 1.0\nstep = 0.1\n";
  EXPECT_EQ(scene_hash(text), "62848357c0201d2b");  // reports/tests/test_trajectory.py
  EXPECT_EQ(scene_hash("[grid]\nspacing = 1\n[time]\nend = 2\nstep = 0.1\n"), scene_hash(text));
  EXPECT_NE(scene_hash("[grid]\nend = 2\n"), scene_hash("[grid]\nend = 3\n"));
}

/// All lines but the verdict's, which is one line whatever it says.
TEST(Table, HasAtMostAHundredColumns) {
  CheckReport report = check_of(find_scene("tiny_impact"), {.steps = 1, .start_step = 150});
  report.fields[0].valid = false;
  std::istringstream table(to_table(report, {.all_rows = true, .colour = false}));
  int lines = 0;
  for (std::string line; std::getline(table, line); ++lines) {
    if (line.rfind("VALID: ", 0) == 0) continue;
    EXPECT_LE(line.size(), 100u) << line;
  }
  EXPECT_GT(lines, 20);
}

TEST(Table, WhatFailedStandsFirst) {
  CheckReport report = check_of(find_scene("tiny_impact"), {.steps = 1, .start_step = 150});
  report.fields[9].valid = false;
  report.fields[9].wrong = 7;
  std::istringstream table(to_table(report));
  std::string line;
  while (line.rfind("stage", 0) != 0) std::getline(table, line);
  std::getline(table, line);
  EXPECT_NE(line.find(name(report.fields[9].field)), std::string::npos) << line;
  std::getline(table, line);
  EXPECT_NE(line.find("7 of "), std::string::npos) << line;
}

}  // namespace
}  // namespace firn
