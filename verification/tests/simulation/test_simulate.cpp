// SPDX-License-Identifier: BSD-3-Clause
/// The run driver: which frames it writes, when it ends, that a resumed run is
/// the uninterrupted one, and what is left after every kind of failure.

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <vector>

#include "firn/error.hpp"
#include "io/trajectory/reader.hpp"
#include "simulation/simulate.hpp"
#include "verification/support/ballistic_solver.hpp"
#include "verification/support/bytes_of.hpp"
#include "verification/support/same_state.hpp"
#include "verification/support/scenes.hpp"
#include "verification/support/temporary_folder.hpp"

namespace firn {
namespace {

using fixtures::adaptive_scene;
using fixtures::BallisticSolver;
using fixtures::same_particles;
using fixtures::TemporaryFolder;
using fixtures::tiny_scene;

RunOptions to_file(const std::filesystem::path& path) {
  RunOptions options;
  options.output = path;
  options.threads = 2;
  options.processor = "test";
  return options;
}

std::vector<std::int64_t> steps_of_frames(const std::filesystem::path& path) {
  const TrajectoryReader reader(path);
  std::vector<std::int64_t> steps;
  for (std::int64_t k = 0; k < reader.frames(); ++k) steps.push_back(*reader.step(k));
  return steps;
}

using Steps = std::vector<std::int64_t>;

TEST(Simulate, WritesTheFramesOfTheRule) {
  const TemporaryFolder folder;
  const Scene scene = tiny_scene();  // 20 steps of 1 ms, a frame every 4 ms
  BallisticSolver solver;
  const RunResult result = simulate(scene, solver, to_file(folder / "out.vtkhdf"));
  EXPECT_EQ(result.exit_status(), 0);
  EXPECT_EQ(result.step, 20);
  EXPECT_EQ(result.steps_by_bound, (std::array<std::int64_t, 4>{20, 0, 0, 0}));
  EXPECT_EQ(steps_of_frames(folder / "out.vtkhdf"), (Steps{0, 4, 8, 12, 16, 20}));
  const TrajectoryReader reader(folder / "out.vtkhdf");
  EXPECT_EQ(reader.rows(), 20);
  EXPECT_EQ(reader.diagnostics()[7].time, reader.time(2));
  EXPECT_EQ(reader.diagnostics()[7].grid_nodes, 64 + 8);
}

TEST(Simulate, WritesTheFirstStepPastEachMarkAndTheLastState) {
  const TemporaryFolder folder;
  const Scene scene = tiny_scene();
  BallisticSolver solver;
  RunOptions options = to_file(folder / "out.vtkhdf");
  options.frames_per_second = 300;  // marks at 3.33, 6.67, 10, 13.33, 16.67 ms
  options.until = 0.0175;           // reached by step 18
  simulate(scene, solver, options);
  EXPECT_EQ(steps_of_frames(folder / "out.vtkhdf"), (Steps{0, 4, 7, 10, 14, 17, 18}));

  options.frames_per_second = 1e6;  // many marks in a step: one frame
  options.steps = 3;
  simulate(scene, solver, options);
  EXPECT_EQ(steps_of_frames(folder / "out.vtkhdf"), (Steps{0, 1, 2, 3}));

  options.steps = 0;
  const RunResult none = simulate(scene, solver, options);
  EXPECT_EQ(none.particles, 5);
  EXPECT_GT(none.diagnostics.mass, 0);  // measured, though no step was made
  EXPECT_EQ(steps_of_frames(folder / "out.vtkhdf"), (Steps{0}));
}

TEST(Simulate, EndsAtTheEndDespiteRounding) {
  // Sums of Δt fall short of the end here, or go past a frame's mark late.
  for (const auto& [dt, steps] :
       {std::pair(1e-4, 10000), std::pair(1e-3, 3000), std::pair(0.1, 30), std::pair(1.0 / 3, 3)}) {
    Scene scene = tiny_scene(1);
    scene.time.step = dt;
    scene.time.end = dt == 1.0 / 3 ? 1.0 : dt * steps;
    scene.time.frames_per_second = 1 / dt;
    std::int64_t frames = 0;
    RunOptions options;
    options.on_frame = [&](const FrameReport&) { ++frames; };
    BallisticSolver solver;
    EXPECT_EQ(simulate(scene, solver, options).step, steps) << dt;
    EXPECT_EQ(frames, steps + 1) << dt;
  }
}

TEST(Simulate, ReservesExactlyWhatAFixedStepNeeds) {
  const TemporaryFolder folder;
  BallisticSolver solver;
  std::uintmax_t first = 0;
  RunOptions options = to_file(folder / "out.vtkhdf");
  options.on_frame = [&](const FrameReport& frame) {
    if (frame.frame == 0) first = std::filesystem::file_size(folder / "out.vtkhdf");
  };
  simulate(tiny_scene(), solver, options);
  EXPECT_EQ(std::filesystem::file_size(folder / "out.vtkhdf"), first);
}

TEST(Simulate, ReportsProgress) {
  BallisticSolver solver;
  RunOptions options;
  options.steps = 10;
  std::vector<double> fractions;
  options.on_step = [&](const Progress& progress) {
    fractions.push_back(progress.fraction);
    EXPECT_EQ(progress.step, static_cast<std::int64_t>(fractions.size()));
    EXPECT_EQ(progress.particles, 5);
    EXPECT_EQ(progress.diagnostics->time, progress.time);
  };
  simulate(tiny_scene(), solver, options);
  ASSERT_EQ(fractions.size(), 10u);
  EXPECT_EQ(fractions.back(), 1);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
}

struct ResumeCase {
  const char* name;
  Scene scene;
  Precision precision;
};

void PrintTo(const ResumeCase& c, std::ostream* out) { *out << c.name; }

class Resuming : public ::testing::TestWithParam<ResumeCase> {};

TEST_P(Resuming, FromEveryFrameEqualsTheUninterruptedRun) {
  const TemporaryFolder folder;
  const Scene& scene = GetParam().scene;
  BallisticSolver solver(GetParam().precision);
  const auto whole = folder / "whole.vtkhdf", again = folder / "again.vtkhdf";
  ASSERT_EQ(simulate(scene, solver, to_file(whole)).exit_status(), 0);
  const std::int64_t frames = TrajectoryReader(whole).frames();
  ASSERT_GE(frames, 5);
  for (std::int64_t frame = 0; frame < frames; ++frame) {
    BallisticSolver fresh(GetParam().precision);
    RunOptions options = to_file(again);
    options.resume = whole;
    options.resume_frame = frame;
    ASSERT_EQ(simulate(scene, fresh, options).exit_status(), 0);
    EXPECT_TRUE(bytes_of(again) == bytes_of(whole)) << "from frame " << frame;
  }
}

TEST_P(Resuming, AfterAnyNumberOfStepsInPlaceEqualsTheUninterruptedRun) {
  const TemporaryFolder folder;
  const Scene& scene = GetParam().scene;
  const auto whole = folder / "whole.vtkhdf", parts = folder / "parts.vtkhdf";
  BallisticSolver solver(GetParam().precision);
  const RunResult all = simulate(scene, solver, to_file(whole));
  for (std::int64_t steps = 0; steps <= all.step; ++steps) {
    RunOptions options = to_file(parts);
    options.steps = steps;
    BallisticSolver first(GetParam().precision), second(GetParam().precision);
    ASSERT_EQ(simulate(scene, first, options).exit_status(), 0);
    ASSERT_EQ(steps_of_frames(parts).back(), steps);
    options.steps.reset();
    options.resume = parts;
    const RunResult rest = simulate(scene, second, options);
    ASSERT_EQ(rest.exit_status(), 0);
    EXPECT_EQ(rest.steps_run, all.step - steps);
    EXPECT_TRUE(bytes_of(parts) == bytes_of(whole)) << "after " << steps << " steps";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, Resuming,
    ::testing::Values(ResumeCase{"fixed", tiny_scene(), Precision::float64},
                      ResumeCase{"fixed_float", tiny_scene(), Precision::float32},
                      ResumeCase{"adaptive", adaptive_scene(), Precision::float64}),
    [](const auto& info) { return info.param.name; });

TEST(Resuming, NeedsTheRestartData) {
  // The test above means something only if the hidden digits matter.
  const TemporaryFolder folder;
  const Scene scene = tiny_scene();
  BallisticSolver solver;
  simulate(scene, solver, to_file(folder / "whole.vtkhdf"));
  const TrajectoryReader reader(folder / "whole.vtkhdf");
  solver.load(scene, reader.read_frame(1));  // without load_restart()
  for (int n = 4; n < 20; ++n) solver.step(scene.time.step);
  State state;
  solver.store(state);
  EXPECT_FALSE(same_particles(state.particles, reader.read_frame(5).particles));
}

TEST(Resuming, RefusesWhatDoesNotFit) {
  const TemporaryFolder folder;
  const auto path = folder / "out.vtkhdf";
  BallisticSolver solver;
  simulate(tiny_scene(), solver, to_file(path));
  const std::string before = bytes_of(path);
  RunOptions options = to_file(path);
  options.resume = path;
  options.resume_frame = 6;
  EXPECT_THROW(simulate(tiny_scene(), solver, options), InputError);
  options.resume_frame.reset();
  EXPECT_THROW(simulate(adaptive_scene(), solver, options), InputError);
  BallisticSolver in_float(Precision::float32);
  EXPECT_THROW(simulate(tiny_scene(), in_float, options), InputError);
  options.resume = folder / "missing.vtkhdf";
  EXPECT_THROW(simulate(tiny_scene(), solver, options), InputError);
  EXPECT_EQ(bytes_of(path), before);
}

TEST(Simulate, RefusesBadOptionsBeforeAnythingIsWritten) {
  const TemporaryFolder folder;
  BallisticSolver solver;
  const auto run = [&](auto change) {
    RunOptions options = to_file(folder / "out.vtkhdf");
    change(options);
    simulate(tiny_scene(), solver, options);
  };
  EXPECT_THROW(run([](RunOptions& o) { o.steps = -1; }), InputError);
  EXPECT_THROW(run([](RunOptions& o) { o.until = -1; }), InputError);
  EXPECT_THROW(run([](RunOptions& o) { o.until = std::nan(""); }), InputError);
  EXPECT_THROW(run([](RunOptions& o) { o.frames_per_second = 0; }), InputError);
  EXPECT_THROW(run([](RunOptions& o) { o.output = "/nowhere/out.vtkhdf"; }), InputError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace firn
