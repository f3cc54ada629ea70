// SPDX-License-Identifier: BSD-3-Clause
/// What was appended is in the file, whatever else happens.

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

#include "firn/error.hpp"
#include "io/hdf5/read.hpp"
#include "io/results/results_file.hpp"

namespace firn::results {
namespace {

namespace fs = std::filesystem;

const Facts machine = {
    {"processor", std::string("P")}, {"git_commit", std::string("abc")}, {"seed", 1.0}};

class ResultsFileTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder); }
  void TearDown() override { fs::remove_all(folder); }
  fs::path folder = fs::temp_directory_path() / ("firn_results_" + std::to_string(getpid()));
  std::string path = (folder / "deep" / "r.h5").string();

  static Case timing(const std::string& name, Status status) {
    Case c;
    c.suite = "steps";
    c.name = name;
    c.status = status;
    c.parameters = {{"threads", 2.0}, {"solver", std::string("x")}};
    c.quantities = {{"time", "ns", "", Quantity::Better::lower, {3, 1, 2}, true}};
    return c;
  }
};

TEST_F(ResultsFileTest, CasesSurviveReopeningAndNoisyOnesAreMeasuredAgain) {
  {
    ResultsFile file(path, machine, {"git_commit"});
    file.append(timing("a/b", Status::measured));
    file.append(timing("c", Status::noisy));
    file.append(timing("d", Status::invalid));
    file.append(timing("e", Status::failed));
  }
  ResultsFile file(path, machine, {"git_commit"});
  EXPECT_TRUE(file.has("steps", "a/b"));
  EXPECT_FALSE(file.has("steps", "c"));
  EXPECT_TRUE(file.has("steps", "d"));
  EXPECT_FALSE(file.has("steps", "e"));
  EXPECT_FALSE(file.has("other", "a/b"));
  file.append(timing("c", Status::measured));
  EXPECT_TRUE(file.has("steps", "c"));
}

/// Those of a noisy case, too: that they are not to be quoted is for its status to say.
TEST_F(ResultsFileTest, EveryRepetitionIsKept) {
  ResultsFile file(path, machine, {});
  file.append(timing("a", Status::measured));
  file.append(timing("b", Status::noisy));
  const hdf5::InputFile h5(path);
  for (const char* name : {"cases/steps/a/quantities/time", "cases/steps/b/quantities/time"}) {
    const hdf5::InputDataset set = h5.dataset(name, hdf5::Kind::real, 1);
    ASSERT_EQ(set.rows(), 3);
    double values[3] = {};
    set.read(0, 3, values);
    EXPECT_EQ(values[0], 3);
    EXPECT_EQ(values[2], 2);
    EXPECT_EQ(h5.text_attribute(name, "units"), "ns");
  }
}

TEST_F(ResultsFileTest, AnotherBuildMayNotAddToIt) {
  { ResultsFile file(path, machine, {"git_commit"}); }
  Facts other = machine;
  other[1].second = std::string("def");
  EXPECT_THROW(ResultsFile(path, other, {"git_commit"}), InputError);
  EXPECT_NO_THROW(ResultsFile(path, other, {"processor"}));
}

TEST_F(ResultsFileTest, AHalfWrittenCopyDoesNotHarmTheFile) {
  { ResultsFile(path, machine, {}).append(timing("a", Status::measured)); }
  // What a kill during an append leaves behind.
  fs::copy_file(path, path + ".part");
  fs::resize_file(path + ".part", fs::file_size(path) / 2);
  ResultsFile file(path, machine, {});
  file.append(timing("b", Status::measured));
  EXPECT_TRUE(file.has("steps", "a"));
  EXPECT_TRUE(file.has("steps", "b"));
}

TEST_F(ResultsFileTest, VerificationIsInvalidIfOneCheckIsOrIfThereWasNone) {
  ResultsFile file(path, machine, {});
  file.append_verification("good", "firn verify", {{"t", "n", 0.5, "VALID", "c"}});
  file.append_verification("bad", "firn verify",
                           {{"t", "n", 0.5, "VALID", "c"}, {"t", "m", 2, "INVALID", "c"}});
  file.append_verification("none", "firn verify", {});
  file.append_mutants("firn verify --mutants", {{"m", "p", "s", "s", "check", true}});
  const hdf5::InputFile h5(path);
  const auto verdict = [&](const char* who) {
    return h5.text_attribute(std::string("verify/") + who, "verdict");
  };
  EXPECT_EQ(verdict("good"), "VALID");
  EXPECT_EQ(verdict("bad"), "INVALID");
  EXPECT_EQ(verdict("none"), "INVALID");
  EXPECT_TRUE(h5.has("mutants/caught_by"));
}

TEST_F(ResultsFileTest, SomethingElseIsRefused) {
  fs::create_directories(fs::path(path).parent_path());
  { std::ofstream(path) << "text"; }
  EXPECT_THROW(ResultsFile(path, machine, {}), InputError);
}

}  // namespace
}  // namespace firn::results
