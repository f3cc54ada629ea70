// Every instruction set that the processor has is dispatched, and each passes
// lockstep against the reference.

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <gtest/gtest.h>

#include "firn/error.hpp"
#include "optimized/optimized_solver.hpp"
#include "reference/reference_solver.hpp"
#include "verification/check/check.hpp"
#include "verification/optimized/snow.hpp"

namespace firn::test {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

class Targets : public testing::Test {
 protected:
  void TearDown() override { unsetenv("FIRN_TARGET"); }
};

TEST_F(Targets, EveryOneIsDispatchedAndValid) {
  const Scene scenes[] = {collision_of_everything(), periodic_snow(true), periodic_snow(false)};
  const auto reference = make_reference_solver({Precision::float64, 1});
  int checked = 0;
  for (const std::string& target : optimized_targets()) {
    ASSERT_EQ(setenv("FIRN_TARGET", lower(target).c_str(), 1), 0);
    EXPECT_EQ(optimized_target_name(), target);
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
  EXPECT_GE(checked, 6);
}

TEST_F(Targets, AnUnknownOneIsRefused) {
  ASSERT_EQ(setenv("FIRN_TARGET", "mmx", 1), 0);
  EXPECT_THROW(optimized(Precision::float32), InputError);
}

}  // namespace
}  // namespace firn::test
