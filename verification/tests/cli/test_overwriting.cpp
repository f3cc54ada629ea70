// SPDX-License-Identifier: BSD-3-Clause
/// No verb destroys one of its inputs or a file that Firn did not write.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>

#include "verification/support/program.hpp"

namespace firn::test {
namespace {

using fixtures::Outcome;
using fixtures::run_firn;
using fixtures::TemporaryFolder;
namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

constexpr const char* scene_text = R"(
name = "fall"
[grid]
spacing = 0.05
[time]
end = 0.01
step = 0.001
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
shape = { type = "particles", file = "fall.vtkhdf" }
[[collider]]
shape = { type = "mesh", file = "floor.obj" }
friction = 0.3
)";

constexpr const char* tetrahedron =
    "v 0 0 -9\nv 1 0 -9\nv 0 1 -9\nv 0 0 -8\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

/// fall.toml, which reads particles and a mesh; foreign.txt, which is nobody's.
class Overwriting : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({"run", "two_particles", "--steps", "3", "-o", "fall.vtkhdf"}).status, 0);
    write("fall.toml", scene_text);
    write("floor.obj", tetrahedron);
    write("foreign.txt", "notes of three years\n");
  }
  Outcome run(const std::vector<std::string>& words) { return run_firn(words, folder_.path()); }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::string bytes(const std::string& name) { return bytes_of(folder_ / name); }

  /// Exit 2, one line that says `says`, and every file as it was.
  void expect_refused(const std::vector<std::string>& words, const std::string& says) {
    const std::map<std::string, std::string> before = contents();
    const Outcome outcome = run(words);
    const std::string line = outcome.err;
    EXPECT_EQ(outcome.status, 2) << line;
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
    EXPECT_NE(line.find(says), std::string::npos) << line;
    EXPECT_TRUE(contents() == before) << "a file was written or lost";
  }

  std::map<std::string, std::string> contents() {
    std::map<std::string, std::string> all;
    for (const std::string& name : folder_.files())
      all[name] = fs::is_directory(folder_ / name) ? "a folder" : bytes(name);
    return all;
  }

  TemporaryFolder folder_;
};

const char* const an_input = "an input";
const char* const foreign = "--force";

TEST_F(Overwriting, TheDefaultOutputIsNoInput) {
  expect_refused({"run", "fall.toml"}, an_input);
  expect_refused({"run", "fall.toml", "--force"}, an_input);
}

TEST_F(Overwriting, NoOutputIsAnInputByWhateverName) {
  fs::create_symlink("fall.vtkhdf", folder_ / "soft.vtkhdf");
  fs::create_hard_link(folder_ / "fall.vtkhdf", folder_ / "hard.vtkhdf");
  fs::create_directory(folder_ / "sub");
  for (const std::string& output :
       {std::string("fall.vtkhdf"), std::string("./sub/../fall.vtkhdf"), std::string("soft.vtkhdf"),
        std::string("hard.vtkhdf"), (folder_ / "fall.vtkhdf").string(), std::string("fall.toml"),
        std::string("floor.obj")}) {
    SCOPED_TRACE(output);
    expect_refused({"run", "fall.toml", "-o", output, "--force"}, an_input);
  }
}

TEST_F(Overwriting, NorIsAFileThatIsWrittenOnTheWay) {
  fs::rename(folder_ / "fall.vtkhdf", folder_ / "out.vtkhdf.partial");
  std::string text = scene_text;
  text.replace(text.find("fall.vtkhdf"), 11, "out.vtkhdf.partial");
  write("fall.toml", text);
  expect_refused({"run", "fall.toml", "-o", "out.vtkhdf"}, an_input);
}

TEST_F(Overwriting, TheSolversOwnFilesAreInputs) {
  write("mine.py", "raise SystemExit\n");
  const std::string solver = "exec:python3 mine.py {in} {out} {steps}";
  expect_refused({"run", "two_particles", "--solver", solver, "-o", "mine.py", "--force"},
                 an_input);
  expect_refused({"bench", "--solver", solver, "-o", "mine.py", "--force"}, an_input);
  expect_refused({"verify", "--solver", solver, "-o", "mine.py", "--force"}, an_input);
  expect_refused({"verify", "--solver", solver, "--junit", "mine.py", "--force"}, an_input);
}

TEST_F(Overwriting, AForeignFileNeedsForce) {
  write("two_particles.vtkhdf", "the default output of the scene\n");
  expect_refused({"run", "two_particles", "--steps", "1"}, foreign);
  for (const char* verb : {"run", "bench", "verify"}) {
    SCOPED_TRACE(verb);
    std::vector<std::string> words = {verb, "-o", "foreign.txt"};
    if (words[0] == "run") words.insert(words.end(), {"two_particles", "--steps", "1"});
    expect_refused(words, foreign);
  }
  expect_refused({"verify", "--junit", "foreign.txt"}, foreign);
  EXPECT_EQ(run({"run", "two_particles", "--steps", "1", "--force"}).status, 0);
  EXPECT_EQ(run({"run", "two_particles", "--steps", "1"}).status, 0) << "its own it replaces";
}

TEST_F(Overwriting, ATrajectoryAndResultsDoNotReplaceEachOther) {
  ASSERT_EQ(run({"bench", "stress/*", "--solver", "reference", "-o", "r.h5", "--quick"}).status, 0);
  expect_refused({"run", "two_particles", "-o", "r.h5"}, foreign);
  expect_refused({"bench", "-o", "fall.vtkhdf"}, foreign);
  EXPECT_EQ(
      run({"bench", "stress/*", "--solver", "reference", "-o", "foreign.txt", "--quick", "--force"})
          .status,
      0);
  EXPECT_EQ(
      run({"bench", "stress/*", "--solver", "reference", "-o", "foreign.txt", "--quick"}).status,
      0);
}

TEST_F(Overwriting, ResumingContinuesItsOwnFile) {
  EXPECT_EQ(run({"run", "two_particles", "--resume", "fall.vtkhdf", "--steps", "5"}).status, 0);
  fs::create_symlink("fall.vtkhdf", folder_ / "soft.vtkhdf");
  EXPECT_EQ(
      run({"run", "two_particles", "--resume", "fall.vtkhdf", "-o", "soft.vtkhdf", "--steps", "6"})
          .status,
      0);
  expect_refused(
      {"run", "two_particles", "--resume", "fall.vtkhdf", "-o", "foreign.txt", "--steps", "7"},
      foreign);
}

}  // namespace
}  // namespace firn::test
