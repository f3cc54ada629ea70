// SPDX-License-Identifier: BSD-3-Clause
/// Lockstep names the stage of every mutant that lives in one.

#include <gtest/gtest.h>
#include <set>

#include "firn/error.hpp"
#include "verification/check/check.hpp"
#include "verification/mutants/mutants.hpp"
#include "verification/support/builtin_registry.hpp"
#include "verification/support/snow_cases.hpp"

namespace firn {
namespace {

using fixtures::builtin_registry;
using fixtures::make_reference;

/// The first case that finds it; an empty report if none does.
CheckReport first_failure(const std::string& solver) {
  for (const fixtures::Case& c : fixtures::snow_cases()) {
    const auto reference = make_reference();
    const auto subject = builtin_registry().create(solver.empty() ? reference_name : solver, {});
    CheckReport report = run_check(c.scene, c.state, *reference, *subject, {.steps = c.steps});
    report.scene = c.name;
    if (!report.valid()) return report;
  }
  return {};
}

TEST(Mutants, AreAtLeastSixtyOfDifferentNames) {
  std::set<std::string> names;
  for (const Mutant& mutant : all_mutants()) {
    names.insert(mutant.name);
    EXPECT_FALSE(mutant.mistake.empty()) << mutant.name;
    EXPECT_FALSE(mutant.origin.empty()) << mutant.name;
  }
  EXPECT_EQ(names.size(), all_mutants().size());
  EXPECT_GE(names.size(), 60u);
  EXPECT_THROW(builtin_registry().create("mutant:no_such_mistake", {}), InputError);
}

TEST(Mutants, UnmutatedItIsValid) {
  const CheckReport report = first_failure("");
  EXPECT_TRUE(report.valid()) << to_table(report);
}

class OneMutant : public testing::TestWithParam<Mutant> {};

TEST_P(OneMutant, IsFoundByCheckInItsStage) {
  const Mutant& mutant = GetParam();
  const CheckReport report = first_failure("mutant:" + mutant.name);
  ASSERT_EQ(!report.valid(), mutant.check_sees_it) << to_table(report);
  if (report.valid()) return;
  const Divergence& first = *report.first_divergence;
  RecordProperty("case", report.scene);
  EXPECT_LE(first.from, mutant.stage) << report.scene << ": " << first.message;
  EXPECT_GE(first.through, mutant.stage) << report.scene << ": " << first.message;
  if (!mutant.several) {
    EXPECT_EQ(first.from, first.through) << report.scene << ": " << first.message;
  }
}

INSTANTIATE_TEST_SUITE_P(All, OneMutant, testing::ValuesIn(all_mutants()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace firn
