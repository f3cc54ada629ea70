// SPDX-License-Identifier: BSD-3-Clause
/// Resuming with the solvers that Firn brings, from every frame of a run in
/// which snow meets a collider: the file of the uninterrupted run, byte for byte.

#include <fstream>
#include <gtest/gtest.h>

#include "io/scene/scene_file.hpp"
#include "io/trajectory/reader.hpp"
#include "simulation/simulate.hpp"
#include "verification/support/builtin_registry.hpp"
#include "verification/support/bytes_of.hpp"
#include "verification/support/temporary_folder.hpp"

namespace firn {
namespace {

using fixtures::builtin_registry;
using fixtures::TemporaryFolder;

struct SolverResumeCase {
  std::string solver;
  Precision precision;
  bool adaptive;
};

void PrintTo(const SolverResumeCase& c, std::ostream* out) {
  *out << c.solver << " " << name(c.precision) << (c.adaptive ? " adaptive" : " fixed");
}

/// Every solver in every precision it has, with fixed and with adaptive steps.
std::vector<SolverResumeCase> all_cases() {
  std::vector<SolverResumeCase> cases;
  for (const SolverEntry& entry : builtin_registry().entries())
    for (const Precision precision : entry.precisions)
      for (const bool adaptive : {false, true}) cases.push_back({entry.name, precision, adaptive});
  return cases;
}

Scene impact(bool adaptive) {
  Scene scene = find_scene("tiny_impact");
  scene.time.adaptive = adaptive;
  scene.time.max_step = 5e-4;
  scene.time.cfl = 0.05;  // 2 mm of the grid's 40 mm: binds at 4 m/s
  scene.time.elastic_cfl = 0.2;
  return scene;
}

class SolverResumes : public ::testing::TestWithParam<SolverResumeCase> {};

TEST_P(SolverResumes, FromEveryFrameEqualsTheUninterruptedRun) {
  const SolverResumeCase& resumed = GetParam();
  const TemporaryFolder folder;
  const Scene scene = impact(resumed.adaptive);
  const auto run = [&](const std::filesystem::path& output, const std::filesystem::path& from,
                       std::int64_t frame) {
    const auto solver = builtin_registry().create(resumed.solver, {resumed.precision, 1});
    RunOptions options;
    options.output = output;
    options.steps = 60;
    options.frames_per_second = 400;
    options.resume = from;
    if (!from.empty()) options.resume_frame = frame;
    const RunResult result = simulate(scene, *solver, options);
    ASSERT_EQ(result.exit_status(), 0) << result.message;
    ASSERT_EQ(result.step, 60);
  };
  const auto whole = folder / "whole.vtkhdf", again = folder / "again.vtkhdf";
  run(whole, {}, 0);
  const std::int64_t frames = TrajectoryReader(whole).frames();
  ASSERT_GE(frames, 5);
  for (std::int64_t frame = 0; frame < frames; ++frame) {
    run(again, whole, frame);
    EXPECT_TRUE(bytes_of(again) == bytes_of(whole)) << "from frame " << frame;
  }
}

INSTANTIATE_TEST_SUITE_P(Builtin, SolverResumes, ::testing::ValuesIn(all_cases()),
                         [](const auto& info) {
                           return info.param.solver + "_" +
                                  std::string(name(info.param.precision)) +
                                  (info.param.adaptive ? "_adaptive" : "_fixed");
                         });

}  // namespace
}  // namespace firn
