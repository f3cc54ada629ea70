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

#ifdef FIRN_PYTHON
/// The box of `collision` turns far enough within six steps to tell which way.
TEST(ExampleScenes, CollisionShowsWhichWayTheBoxTurns) {
  std::ifstream file(FIRN_SOURCE_DIR "/examples/python/mpm.py");
  std::string code{std::istreambuf_iterator<char>(file), {}};
  const std::string right = "np.eye(3) + np.sin(angle) * K",
                    wrong = "np.eye(3) - np.sin(angle) * K";
  const std::size_t at = code.find(right);
  ASSERT_NE(at, std::string::npos);
  const TemporaryFolder folder;
  std::ofstream(folder / "wrong.py") << code.replace(at, right.size(), wrong);
  const Outcome outcome =
      run_firn({"check", example("collision"), "--steps", "6", "--solver",
                "exec:" FIRN_PYTHON " " + (folder / "wrong.py").string() + " {in} {out} {steps}"},
               folder.path());
  EXPECT_EQ(outcome.status, 1) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("INVALID"), std::string::npos) << outcome.out;
}
#endif

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

/// Status 77 is no failure: the scene does not apply, and the guest says why.
TEST(Unsupported, CommandSaysNo) {
  const TemporaryFolder folder;
  const std::string guest = "exec:sh -c 'echo no snow today >&2; exit 77' {in} {out} {steps}";
  const Outcome check = run_firn({"check", "two_particles", "--solver", guest}, folder.path());
  EXPECT_EQ(check.status, 2) << check.out << check.err;
  EXPECT_NE(check.err.find("does not support this: no snow today"), std::string::npos) << check.err;

  const Outcome verify =
      run_firn({"verify", "--filter",
                "Kernel.one_step*:Lockstep.lump_on_a_slope:SemiImplicit.beta*", "--solver", guest},
               folder.path());
  EXPECT_EQ(verify.status, 1) << verify.out << verify.err;
  EXPECT_NE(verify.out.find("NO VERDICT"), std::string::npos) << verify.out;
  EXPECT_NE(verify.out.find("does not apply"), std::string::npos) << verify.out;
  EXPECT_EQ(verify.out.find("INVALID"), std::string::npos) << verify.out;
}

}  // namespace
}  // namespace firn::test
