// SPDX-License-Identifier: BSD-3-Clause
#include "verification/tests/check/builtin_runs.hpp"

namespace firn::test {
namespace {

class SceneOfOurs : public testing::TestWithParam<Run> {};

TEST_P(SceneOfOurs, IsValidAtItsStart) { expect_valid(GetParam(), {.steps = 2}); }

INSTANTIATE_TEST_SUITE_P(Builtin, SceneOfOurs, testing::ValuesIn(all_runs()), run_name);

}  // namespace
}  // namespace firn::test
