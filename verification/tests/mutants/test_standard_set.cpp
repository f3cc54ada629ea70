// SPDX-License-Identifier: BSD-3-Clause
/// What `firn check` compares without a scene: the fewest cases that show every mutant.

#include <algorithm>
#include <gtest/gtest.h>
#include <string>

#include "io/scene/scene_file.hpp"
#include "verification/check/check_set.hpp"
#include "verification/check/windows.hpp"
#include "verification/mutants/mutants.hpp"
#include "verification/studies/standard_set.hpp"
#include "verification/support/builtin_registry.hpp"

namespace firn {
namespace {

using fixtures::builtin_registry;
using fixtures::make_reference;
using studies::StandardCase;

bool catches(const StandardCase& c, const std::string& solver) {
  const auto subject = builtin_registry().create(solver, {});
  return !run_check(c.scene, c.windows, *make_reference(), *subject).valid();
}

/// The cases that may be in the set: those with which the checker is tested, and small built-in
/// scenes in the steps that a check of them would choose.
std::vector<StandardCase> candidates() {
  std::vector<StandardCase> list = studies::candidates();
  for (const char* name : {"tiny_impact", "two_particles"}) {
    const Scene scene = find_scene(name);
    WindowOptions options;
    options.steps = 3;
    const auto scout = builtin_registry().create("optimized", {});
    list.push_back(
        {name, scene, plan_windows(scene, initial_state(scene), *scout, options).windows});
  }
  return list;
}

TEST(StandardSet, IsTheSmallestThatShowsEveryMutantACheckCanSee) {
  const std::vector<StandardCase> all = candidates();
  std::vector<std::vector<bool>> caught(all.size());
  for (const Mutant& mutant : all_mutants()) {
    bool seen = false;
    for (std::size_t c = 0; c < all.size(); ++c) {
      caught[c].push_back(catches(all[c], "mutant:" + mutant.name));
      seen = seen || caught[c].back();
    }
    EXPECT_EQ(seen, mutant.check_sees_it) << mutant.name;
  }
  std::vector<std::string> smallest, standard;
  for (const std::size_t c : studies::smallest_set(caught)) smallest.push_back(all[c].name);
  for (const StandardCase& c : studies::standard_set()) standard.push_back(c.name);
  EXPECT_EQ(standard, smallest);
}

TEST(StandardSet, LacksNothingThatItsScenesCallFor) {
  CheckSet set;
  for (const StandardCase& c : studies::standard_set())
    set.reports.push_back(run_check(c.scene, c.windows, *make_reference(), *make_reference()));
  EXPECT_TRUE(set.valid());
  EXPECT_EQ(set.not_exercised(), std::vector<std::string>{});
}

TEST(StandardSet, SmallestSetsAreFound) {
  const std::vector<std::vector<bool>> rows = {
      {true, true, false, false}, {false, true, true, false}, {true, false, true, false}};
  EXPECT_EQ(studies::smallest_set(rows), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(studies::smallest_set({{false, false}}), std::vector<std::size_t>{});
}

}  // namespace
}  // namespace firn
