// SPDX-License-Identifier: BSD-3-Clause
/// The example guests are VALID: in C stage by stage, in Python step by step.

#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "verification/support/program.hpp"

namespace firn::test {
namespace {

using fixtures::Outcome;
using fixtures::run_firn;
using fixtures::TemporaryFolder;

#ifdef FIRN_PYTHON
const std::string python_guest =
    "exec:" FIRN_PYTHON " " FIRN_SOURCE_DIR "/examples/python/mpm.py {in} {out} {steps}";
#endif

nlohmann::json expect_valid(const std::string& scene, const std::string& guest, int steps) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_firn({"check", scene, "--steps", std::to_string(steps), "--solver", guest, "--json"},
               folder.path());
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  return nlohmann::json::parse(outcome.out, nullptr, false);
}

std::string example(const char* name) {
  return FIRN_SOURCE_DIR "/examples/scenes/" + std::string(name) + ".toml";
}

class ExampleScene : public testing::TestWithParam<const char*> {};

TEST_P(ExampleScene, GuestInCIsValid) {
  expect_valid(example(GetParam()), FIRN_EXAMPLE_LIBRARY, 20);
}

#ifdef FIRN_PYTHON
TEST_P(ExampleScene, GuestInPythonIsValid) { expect_valid(example(GetParam()), python_guest, 6); }
#endif

INSTANTIATE_TEST_SUITE_P(All, ExampleScene, testing::Values("elastic", "plastic", "collision"),
                         [](const auto& info) { return std::string(info.param); });

/// The scenes are about what they say: something yields, something touches.
TEST(ExampleScenes, ShowWhatTheyAreNamedAfter) {
  const auto last = [](const char* name) {
    const TemporaryFolder folder;
    const Outcome outcome =
        run_firn({"run", example(name), "-o", "a.vtkhdf", "--json"}, folder.path());
    return nlohmann::json::parse(outcome.out)["diagnostics"];
  };
  const auto elastic = last("elastic"), plastic = last("plastic"), collision = last("collision");
  EXPECT_GT(elastic["elastic_energy"], 0.1) << "the block stretches as it spins";
  // Half the momentum of each lump would be left if they had passed through each other.
  EXPECT_LT(plastic["kinetic_energy"], 0.05 * 0.5 * 6.05 * 64);
  // Free fall of 3.2 kg over 0.05 s from v_z = −4 would end at −14.4 kg m/s.
  EXPECT_GT(collision["momentum"][2], 0.0);
}

/// Scenes in which other things happen than in the three: periodic axes, adaptive steps.
TEST(ExampleGuests, PeriodicAndAdaptive) {
  expect_valid("shear_periodic", FIRN_EXAMPLE_LIBRARY, 1);
  expect_valid("snowball_wall", FIRN_EXAMPLE_LIBRARY, 2);
#ifdef FIRN_PYTHON
  expect_valid("shear_periodic", python_guest, 1);
  expect_valid("snowball_wall", python_guest, 1);
#endif
}

/// A scene that the guest does not support is its user's mistake: one line, exit 2.
TEST(ExampleGuests, SemiImplicitIsRefused) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_firn({"check", "stiff_block", "--solver", FIRN_EXAMPLE_LIBRARY}, folder.path());
  EXPECT_EQ(outcome.status, 2) << outcome.out << outcome.err;
  EXPECT_NE(outcome.err.find("semi-implicit"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace firn::test
