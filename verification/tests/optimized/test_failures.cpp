// SPDX-License-Identifier: BSD-3-Clause
// A step that fails after it has begun to change particles: the solver says that the state
// is lost, and a run still ends with the last good one in its file, to the last bit.

#include <gtest/gtest.h>

#include "firn/error.hpp"
#include "io/trajectory/reader.hpp"
#include "simulation/simulate.hpp"
#include "verification/support/same_state.hpp"
#include "verification/support/temporary_folder.hpp"
#include "verification/support/through_float.hpp"
#include "verification/tests/optimized/snow_scenes.hpp"

namespace firn::test {
namespace {

/// Falls by n·0.3 h in step n: more than 4 cells in step 14.
Scene falls_too_fast() {
  Scene scene = block_at_rest();
  scene.colliders.clear();
  scene.gravity = Vec3(0, 0, -0.3 * scene.grid.spacing / (scene.time.step * scene.time.step));
  scene.time.end = 20 * scene.time.step;
  scene.time.frames_per_second = 1 / (5 * scene.time.step);
  return scene;
}

class Failures : public ::testing::TestWithParam<Precision> {
 protected:
  State after(const Scene& scene, int steps) {
    const auto solver = optimized(GetParam(), 1);
    State state = initial_state(scene);
    solver->load(scene, state);
    for (int n = 0; n < steps; ++n) solver->step(scene.time.step);
    solver->store(state);
    return state;
  }
};

TEST_P(Failures, StateIsLostAndTheSolverSaysSo) {
  const Scene scene = falls_too_fast();
  const auto solver = optimized(GetParam(), 1);
  solver->load(scene, initial_state(scene));
  for (int n = 1; n < 14; ++n) solver->step(scene.time.step);
  try {
    solver->step(scene.time.step);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const SimulationError& error) {
    EXPECT_EQ(error.stage(), Stage::positions);
    EXPECT_EQ(error.subject(), SimulationError::Subject::particle);
    EXPECT_FALSE(error.state_intact);
  }
}

TEST_P(Failures, ARunEndsWithTheLastGoodState) {
  const Scene scene = falls_too_fast();
  const fixtures::TemporaryFolder folder;
  RunOptions options;
  options.output = folder / "out.vtkhdf";
  const auto solver = optimized(GetParam(), 2);
  const RunResult result = simulate(scene, *solver, options);
  EXPECT_EQ(result.exit_status(), 3);
  EXPECT_EQ(result.step, 13);
  EXPECT_NE(result.message.find("stage 10 (positions), particle"), std::string::npos)
      << result.message;
  EXPECT_EQ(result.message.find("lost"), std::string::npos) << result.message;

  const TrajectoryReader reader(options.output);
  const State last = reader.read_frame(reader.frames() - 1);
  EXPECT_EQ(last.step, 13);
  EXPECT_EQ(reader.rows(), 13);
  State expected = after(scene, 13);
  if (GetParam() == Precision::float32)  // so does the file
    expected.particles = fixtures::through_float(expected.particles);
  EXPECT_TRUE(fixtures::same_particles(last.particles, expected.particles));
}

INSTANTIATE_TEST_SUITE_P(Precisions, Failures,
                         ::testing::Values(Precision::float64, Precision::float32),
                         [](const auto& info) { return std::string(name(info.param)) + "_"; });

}  // namespace
}  // namespace firn::test
