// SPDX-License-Identifier: BSD-3-Clause
/// What a run leaves behind when a step fails, when the user interrupts it and
/// when the disk is full: the last good state, bit for bit the uninterrupted
/// run's state at that step, and a file that can be continued.

#include <atomic>
#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/resource.h>

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

/// The state after `steps` steps of a run that nothing disturbs.
Particles undisturbed(const Scene& scene, std::int64_t steps) {
  BallisticSolver solver;
  solver.load(scene, initial_state(scene));
  for (std::int64_t n = 0; n < steps; ++n) solver.step(solver.choose_time_step().dt);
  State state;
  solver.store(state);
  return state.particles;
}

/// Fails in `step` as long as `until_dt` or more is asked for.
void fail_at(BallisticSolver& solver, std::int64_t step, bool state_intact, double until_dt = 0) {
  solver.failure = [=, &solver](std::int64_t n, double dt) {
    if (n != step || dt < until_dt) return;
    SimulationError error(Stage::deformation, SimulationError::Subject::particle, 3, "broken");
    error.state_intact = state_intact;
    if (!state_intact) solver.scramble();
    throw error;
  };
}

class Failing : public ::testing::Test {
 protected:
  RunOptions options() {
    RunOptions o;
    o.output = folder_ / "out.vtkhdf";
    return o;
  }
  void expect_last_frame(const Scene& scene, std::int64_t step) {
    const TrajectoryReader reader(folder_ / "out.vtkhdf");
    const State last = reader.read_frame(reader.frames() - 1);
    EXPECT_EQ(last.step, step);
    EXPECT_TRUE(same_particles(last.particles, undisturbed(scene, step)));
    EXPECT_EQ(reader.rows(), step);
  }
  /// Without what disturbed it, the run goes on as if nothing had happened.
  void expect_continuable(const Scene& scene) {
    BallisticSolver solver;
    RunOptions o;
    o.output = folder_ / "whole.vtkhdf";
    simulate(scene, solver, o);
    o = options();
    o.resume = o.output;
    EXPECT_EQ(simulate(scene, solver, o).exit_status(), 0);
    EXPECT_TRUE(bytes_of(o.output) == bytes_of(folder_ / "whole.vtkhdf"));
  }
  TemporaryFolder folder_;
};

class FailingStep : public Failing, public ::testing::WithParamInterface<bool> {};

TEST_P(FailingStep, LeavesTheStateBeforeIt) {
  const bool intact = GetParam();
  for (const std::int64_t step : {0, 1, 4, 6, 19}) {
    SCOPED_TRACE(step);
    for (const Scene& scene : {tiny_scene(), adaptive_scene()}) {
      BallisticSolver solver;
      fail_at(solver, step, intact);
      const RunResult result = simulate(scene, solver, options());
      EXPECT_EQ(result.exit_status(), 3);
      EXPECT_EQ(result.message, "stage 7 (deformation), particle 3: broken");
      EXPECT_EQ(result.step, step);
      EXPECT_EQ(solver.loads, intact ? 1 : 2);
      expect_last_frame(scene, step);
      expect_continuable(scene);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(State, FailingStep, ::testing::Bool(),
                         [](const auto& info) { return info.param ? "intact" : "lost"; });

TEST_F(Failing, NonFiniteDiagnosticsAreAFailureThatNamesTheParticle) {
  const Scene scene = tiny_scene();
  BallisticSolver solver;
  solver.poison_at_step = 6;
  const RunResult result = simulate(scene, solver, options());
  EXPECT_EQ(result.exit_status(), 3);
  EXPECT_NE(result.message.find("particle 2"), std::string::npos) << result.message;
  EXPECT_NE(result.message.find("not finite"), std::string::npos) << result.message;
  EXPECT_EQ(result.step, 6);
  expect_last_frame(scene, 6);
  expect_continuable(scene);
}

TEST_F(Failing, ASolverThatCannotRepeatItsStepsLeavesTheLastFrame) {
  // A guest that died: from step 6 on it throws whatever it is asked for.
  const Scene scene = tiny_scene();
  BallisticSolver solver;
  bool dead = false;
  solver.failure = [&](std::int64_t n, double) {
    dead = dead || n == 6;
    if (dead) throw std::runtime_error("the guest is gone");
  };
  const RunResult result = simulate(scene, solver, options());
  EXPECT_EQ(result.exit_status(), 3);
  EXPECT_EQ(
      result.message,
      "the guest is gone; the steps since step 4 are lost, because repeating them failed: the "
      "guest is gone");
  EXPECT_EQ(result.step, 4);
  expect_last_frame(scene, 4);
  expect_continuable(scene);
}

TEST_F(Failing, ATimeStepThatIsNoneFails) {
  Scene scene = tiny_scene();
  for (const double step : {0.0, -1e-3, std::nan("")}) {
    scene.time.step = step;
    BallisticSolver solver;
    const RunResult result = simulate(scene, solver, {});
    EXPECT_EQ(result.exit_status(), 3) << step;
    EXPECT_NE(result.message.find("does not advance"), std::string::npos) << result.message;
    EXPECT_EQ(solver.steps_tried, 0);
  }
}

TEST_F(Failing, InterruptedItWritesTheStateItHas) {
  const Scene scene = tiny_scene();
  for (const std::int64_t step : {0, 1, 4, 7}) {
    std::atomic<bool> stop = step == 0;
    RunOptions o = options();
    o.stop = &stop;
    o.on_step = [&](const Progress& progress) { stop = progress.step == step; };
    BallisticSolver solver;
    const RunResult result = simulate(scene, solver, o);
    EXPECT_EQ(result.exit_status(), 130);
    EXPECT_EQ(result.step, step);
    expect_last_frame(scene, step);
    expect_continuable(scene);
  }
}

TEST_F(Failing, SemiImplicitAndAdaptiveItTriesSmallerSteps) {
  for (const bool intact : {true, false}) {
    Scene scene = adaptive_scene();
    scene.integrator.type = IntegratorType::semi_implicit;
    BallisticSolver solver;
    fail_at(solver, 6, intact, 1e-4);  // Δt is at most 1 ms: four halvings at most
    std::vector<Retry> retries;
    RunOptions o = options();
    o.on_retry = [&](const Retry& retry) { retries.push_back(retry); };
    const RunResult result = simulate(scene, solver, o);
    EXPECT_EQ(result.exit_status(), 0);
    ASSERT_GE(retries.size(), 2u);
    EXPECT_EQ(result.retries, static_cast<std::int64_t>(retries.size()));
    for (std::size_t i = 0; i < retries.size(); ++i) {
      EXPECT_EQ(retries[i].step, 6);
      EXPECT_EQ(retries[i].attempt, static_cast<int>(i + 1));
      EXPECT_EQ(retries[i].next_dt, retries[i].dt / 2);
      EXPECT_NE(retries[i].message.find("broken"), std::string::npos);
    }
    const TrajectoryReader reader(o.output);
    EXPECT_EQ(reader.diagnostics()[6].dt, retries.back().next_dt);
    // Lost states are brought back by repeating the steps since the last frame
    // once; after that the state before the failing step is at hand.
    EXPECT_EQ(solver.loads, intact ? 1 : 1 + static_cast<std::int64_t>(retries.size()));

    // … and the result is that of a run which chose these steps itself.
    BallisticSolver plain;
    plain.load(scene, initial_state(scene));
    for (const Diagnostics& row : reader.diagnostics()) plain.step(row.dt);
    State expected;
    plain.store(expected);
    EXPECT_TRUE(
        same_particles(reader.read_frame(reader.frames() - 1).particles, expected.particles));
  }
}

TEST_F(Failing, ItGivesUpAfterTenSmallerSteps) {
  Scene scene = adaptive_scene();
  scene.integrator.type = IntegratorType::semi_implicit;
  BallisticSolver solver;
  fail_at(solver, 6, false);
  const RunResult result = simulate(scene, solver, options());
  EXPECT_EQ(result.exit_status(), 3);
  EXPECT_EQ(result.retries, 10);
  EXPECT_EQ(result.step, 6);
  expect_last_frame(scene, 6);
}

TEST_F(Failing, OnlySemiImplicitAndAdaptiveScenesRetry) {
  Scene fixed = tiny_scene();
  fixed.integrator.type = IntegratorType::semi_implicit;
  for (const Scene& scene : {fixed, adaptive_scene()}) {
    BallisticSolver solver;
    fail_at(solver, 6, true);
    EXPECT_EQ(simulate(scene, solver, options()).retries, 0);
  }
}

/// A disk that is full: no file may grow beyond `bytes` while this lives.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, SIG_IGN);  // then write() fails with EFBIG
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, SIG_DFL);
  }

 private:
  rlimit before_{};
};

TEST_F(Failing, WithoutRoomItRefusesBeforeAnythingIsComputed) {
  const Scene scene = tiny_scene(1000);  // 6 frames of 200 kB
  BallisticSolver solver;
  const FullDisk disk(500'000);
  EXPECT_THROW(simulate(scene, solver, options()), InputError);
  EXPECT_EQ(solver.steps_tried, 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(Failing, WhereTheFileCannotGrowTheFramesInItStay) {
  // The step shrinks to a tenth, so the rows need a larger file in the middle of the run.
  Scene scene = adaptive_scene();
  scene.gravity *= 1000;
  scene.time.end = 0.01;
  scene.time.cfl = 0.12;
  BallisticSolver solver;
  RunOptions o = options();
  std::int64_t reported = 0;
  std::unique_ptr<FullDisk> disk;
  o.on_frame = [&](const FrameReport& frame) {
    ++reported;
    if (frame.frame == 0) disk = std::make_unique<FullDisk>(std::filesystem::file_size(o.output));
  };
  const RunResult result = simulate(scene, solver, o);
  disk.reset();
  EXPECT_EQ(result.exit_status(), 3);
  EXPECT_NE(result.message.find("File too large"), std::string::npos) << result.message;
  EXPECT_EQ(result.frames, reported);
  const TrajectoryReader reader(o.output);
  EXPECT_EQ(reader.frames(), reported);
  EXPECT_EQ(*reader.step(reported - 1), result.step);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.vtkhdf.partial"));
  expect_continuable(scene);
}

}  // namespace
}  // namespace firn
