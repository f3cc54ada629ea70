// SPDX-License-Identifier: BSD-3-Clause
/// Ctrl-C where a verb cannot look at a flag, scenes that do not fit into memory, and bytes that
/// are no text.

#include <algorithm>
#include <chrono>
#include <fstream>
#include <gtest/gtest.h>

#include "verification/support/program.hpp"

namespace firn::test {
namespace {

using fixtures::Outcome;
using fixtures::run_firn;
using fixtures::TemporaryFolder;
using namespace std::chrono_literals;

std::ptrdiff_t count_lines(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

/// A thin rod across 1.5·10⁹ sub-cells: few particles, and many seconds of sampling.
constexpr const char* rod = R"(
name = "rod"
[grid]
spacing = 0.01
[time]
end = 0.001
step = 0.0001
frames_per_second = 48
[integrator]
type = "explicit"
[transfer]
flip = 0.95
[[material]]
name = "snow"
youngs_modulus = 1.4e5
poisson_ratio = 0.2
density = 400.0
hardening = 10.0
critical_compression = 2.5e-2
critical_stretch = 7.5e-3
[[body]]
material = "snow"
shape = { type = "cylinder", center = [0, 0, 0], axis = [1, 1, 1], radius = 0.006, height = 10 }
particles_per_cell = 8
sampling = "lattice"
seed = 1
volumes = "exact"
)";

TEST(Interruption, EndsWhatCannotLookAtAFlag) {
  const TemporaryFolder folder;
  std::ofstream(folder / "rod.toml") << rod;
  const Outcome outcome = run_firn({"run", "rod.toml"}, folder.path(), 500ms);
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_EQ(outcome.err, "firn: interrupted\n");
  EXPECT_EQ(folder.files(), std::vector<std::string>{"rod.toml"})
      << "sampling went on, and the run began";
}

TEST(Interruption, EndsTheVerification) {
  const TemporaryFolder folder;
  const Outcome outcome = run_firn({"verify", "--json"}, folder.path(), 700ms);
  EXPECT_EQ(outcome.status, 130);
  EXPECT_NE(outcome.err.find("firn: interrupted\n"), std::string::npos) << outcome.err;
}

TEST(Memory, ASceneThatDoesNotFitIsRefusedWithBothNumbers) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"run", "snowball_drop", "--scale", "60"},
        {"run", "snowball_drop", "--scale", "60", "--solver", "reference"},
        {"check", "snowball_drop", "--scale", "60"},
        {"teach", "snowball_drop", "--scale", "60"}}) {
    const Outcome outcome = run_firn(words, folder.path());
    SCOPED_TRACE(words[0] + ": " + outcome.err);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(count_lines(outcome.err), 1);
    EXPECT_NE(outcome.err.find("memory for about "), std::string::npos);
    EXPECT_NE(outcome.err.find("GB available"), std::string::npos);
    EXPECT_TRUE(folder.files().empty());
  }
  EXPECT_EQ(run_firn({"run", "snowball_drop", "--scale", "100"}, folder.path()).status, 2);
}

TEST(Messages, HaveNoBytesThatAreNoText) {
  const TemporaryFolder folder;
  std::ofstream(folder / "bad\xC0.toml") << "name = \"\xC0\"\n";
  for (const std::vector<std::string>& words : {std::vector<std::string>{"run", "bad\xC0.toml"},
                                                {"run", "tiny_impact", "--warp\xC0"},
                                                {"melt\xC0"},
                                                {"run", "two_particles", "--solver", "so\xC0lver"},
                                                {"run", "two_particles", "-o", "no\xC0/out.vtkhdf"},
                                                {"compare", "a\xC0", "b\xC0\x80"},
                                                {"verify", "--solver", "so\xC0lver"},
                                                {"report", "re\xC0.h5"}}) {
    const Outcome outcome = run_firn(words, folder.path());
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_EQ(outcome.err.find('\xC0'), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("\\xC0"), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace firn::test
