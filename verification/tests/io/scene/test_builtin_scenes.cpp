// SPDX-License-Identifier: BSD-3-Clause
// Every built-in scene starts well on the reference, and the free fall that
// snowball_drop promises is exact.

#include <algorithm>
#include <limits>

#include "io/scene/builtin_scenes.hpp"
#include "verification/tests/io/scene/scene_run.hpp"

namespace firn {
namespace {

TEST(BuiltinScenes, StartFinite) {
  for (const BuiltinScene& builtin : builtin_scenes()) {
    SCOPED_TRACE(builtin.name);
    SceneRun run(builtin.name);
    const double mass = run.measure().mass;
    run.run(run.scene.time.end, 10);
    const Diagnostics after = run.measure();
    EXPECT_EQ(run.steps, 10);
    EXPECT_EQ(after.mass, mass);
    EXPECT_TRUE(std::isfinite(after.kinetic_energy + after.elastic_energy));
    EXPECT_GT(after.min_J_E, 0);
  }
}

// While nothing touches the ball, X = X0 + n Δt V0 + g Δt² n(n+1)/2 whatever
// its particles do among themselves.
TEST(BuiltinScenes, SnowballDropFallsFreely) {
  SceneRun run("snowball_drop");
  const Diagnostics start = run.measure();
  run.run(0.01, 1000);
  const double n = static_cast<double>(run.steps), dt = run.scene.time.step;
  ASSERT_EQ(n, 100);
  const Vec3 V0 = start.momentum / start.mass;
  const Vec3 X = start.center_of_mass + n * dt * V0 + run.scene.gravity * dt * dt * n * (n + 1) / 2;
  // Each step rounds x + Δt v and the sums over a node's particles: n·eps of
  // the largest position, and as much again for the sums.
  const double bound = 2 * n * std::numeric_limits<double>::epsilon();
  EXPECT_LE((run.measure().center_of_mass - X).cwiseAbs().maxCoeff(), bound);
}

}  // namespace
}  // namespace firn
