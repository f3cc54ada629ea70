// SPDX-License-Identifier: BSD-3-Clause
/// In the middle of what a scene is about, when snow yields and touches things. Long:
/// the reference has to get there first.

#include "verification/tests/check/builtin_runs.hpp"

namespace firn::test {
namespace {

class MiddleOfScene : public testing::TestWithParam<Run> {};

TEST_P(MiddleOfScene, IsValid) {
  const Scene scene = find_scene(GetParam().scene);
  const double dt = scene.time.adaptive ? scene.time.max_step : scene.time.step;
  CheckOptions options{.steps = 3};
  options.start_step = static_cast<std::int64_t>(0.5 * scene.time.end / dt);
  expect_valid(GetParam(), options);
}

INSTANTIATE_TEST_SUITE_P(Builtin, MiddleOfScene, testing::ValuesIn(all_runs()), run_name);

}  // namespace
}  // namespace firn::test
