// SPDX-License-Identifier: BSD-3-Clause
/// Verbs, exit statuses and messages of the program.

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/trajectory/reader.hpp"
#include "verification/support/program.hpp"

namespace firn::test {
namespace {

using fixtures::Outcome;
using fixtures::run_firn;
using fixtures::TemporaryFolder;

using Words = std::vector<std::string>;

std::ptrdiff_t lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

TEST(Cli, HelpNamesEveryVerbAndEveryExitStatus) {
  const TemporaryFolder folder;
  const Outcome help = run_firn({"--help"}, folder.path());
  EXPECT_EQ(help.status, 0);
  for (const char* word : {"run", "check", "compare", "report", "info", "scenes", "solvers", "130"})
    EXPECT_NE(help.out.find(word), std::string::npos) << word;
}

struct BadUsage {
  const char* name;
  Words words;
  const char* says;  ///< part of the one line on stderr
};

class CliBadUsage : public testing::TestWithParam<BadUsage> {};

TEST_P(CliBadUsage, OneLineExitTwoNothingWritten) {
  const TemporaryFolder folder;
  const Outcome outcome = run_firn(GetParam().words, folder.path());
  EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(lines(outcome.err), 1) << outcome.err;
  EXPECT_NE(outcome.err.find(GetParam().says), std::string::npos) << outcome.err;
  EXPECT_EQ(folder.files(), Words{});
}

const BadUsage bad_usages[] = {
    {"NoVerb", {}, "subcommand"},
    {"UnknownVerb", {"melt"}, "melt"},
    {"UnknownOption", {"run", "tiny_impact", "--warp"}, "--warp"},
    {"NoScene", {"run"}, "SCENE"},
    {"UnknownScene", {"run", "snowball_dorp"}, "snowball_drop"},
    {"MissingFile", {"run", "./missing.toml"}, "missing.toml"},
    {"FolderAsScene", {"run", "/tmp/"}, "/tmp/"},
    {"RequireOfSomethingElse", {"check", "tiny_impact", "--require", "snow"}, "plastic, "},
    {"DumpWithoutAScene", {"check", "--dump", "e.vtkhdf"}, "SCENE"},
    {"NoBudget", {"check", "tiny_impact", "--budget", "0"}, "above 0"},
    {"NegativeStartStep", {"check", "tiny_impact", "--start-step", "-2"}, "at least 0"},
    {"UnknownSolver", {"run", "tiny_impact", "--solver", "fast"}, "reference"},
    {"UnknownPrecision", {"run", "tiny_impact", "--precision", "half"}, "double or float"},
    {"ReferenceInFloat",
     {"run", "tiny_impact", "--solver", "reference", "--precision", "float"},
     "double"},
    {"NegativeSteps", {"run", "tiny_impact", "--steps", "-1"}, "-1"},
    {"NegativeEnd", {"run", "tiny_impact", "--until", "-0.5"}, "-0.5"},
    {"NanEnd", {"run", "tiny_impact", "--until", "nan"}, "nan"},
    {"ZeroFrameRate", {"run", "tiny_impact", "--frames-per-second", "0"}, "above 0"},
    {"WordForThreads", {"run", "tiny_impact", "--threads", "two"}, "two"},
    {"TooManyThreads", {"run", "tiny_impact", "--threads", "99999"}, "1024"},
    {"ZeroScale", {"run", "tiny_impact", "--scale", "0"}, "scale"},
    {"OutputInMissingFolder",
     {"run", "tiny_impact", "-o", "no/such/folder/out.vtkhdf"},
     "no/such/folder"},
    {"ResumeFromMissingFile", {"run", "tiny_impact", "--resume", "gone.vtkhdf"}, "gone.vtkhdf"},
    {"ResumeFrameAlone", {"run", "tiny_impact", "--resume-frame", "1"}, "--resume"},
    {"UnknownMode", {"check", "tiny_impact", "--mode", "race"}, "lockstep or free"},
    {"NoStepsToCheck", {"check", "tiny_impact", "--steps", "0"}, "at least 1"},
    {"CompareMissing", {"compare", "a.vtkhdf", "b.vtkhdf"}, "a.vtkhdf"},
    {"CompareOneFile", {"compare", "a.vtkhdf"}, "B"},
    {"ReportOfNothing", {"report", "nothing.h5"}, "nothing.h5"},
    {"ShowUnknownScene", {"scenes", "--show", "avalanche"}, "avalanche"},
    {"MissingLibrary", {"check", "tiny_impact", "--solver", "./libmissing.so"}, "libmissing.so"},
    {"CommandWithoutPlaceholder",
     {"check", "tiny_impact", "--solver", "exec:true {in} {out}"},
     "{steps}"},
    {"CommandThatIsNotThere",
     {"check", "two_particles", "--solver", "exec:/no/such/program {in} {out} {steps}"},
     "/no/such/program"},
};

INSTANTIATE_TEST_SUITE_P(All, CliBadUsage, testing::ValuesIn(bad_usages),
                         [](const auto& info) { return info.param.name; });

TEST(Cli, ListsArePlainAndJson) {
  const TemporaryFolder folder;
  const Outcome plain = run_firn({"scenes"}, folder.path());
  const Outcome json = run_firn({"scenes", "--json"}, folder.path());
  const auto list = nlohmann::json::parse(json.out);
  EXPECT_EQ(lines(plain.out), static_cast<std::ptrdiff_t>(list.size()));
  for (const char* scene : {"snowball_drop", "snowball_smash", "snowball_wall", "snow_plow",
                            "wedge", "column", "rolling_snowball"})
    EXPECT_TRUE(std::any_of(list.begin(), list.end(), [&](const auto& s) {
      return s["name"] == scene;
    })) << scene;
  const auto solvers = nlohmann::json::parse(run_firn({"solvers", "--json"}, folder.path()).out);
  ASSERT_GE(solvers.size(), 2u);
  EXPECT_EQ(solvers[0]["name"], "reference");
  const auto info = nlohmann::json::parse(run_firn({"info", "--json"}, folder.path()).out);
  EXPECT_NE(info["instruction_set"], "");
}

TEST(Cli, ZeroStepsWriteTheInitialStateOnly) {
  const TemporaryFolder folder;
  ASSERT_EQ(
      run_firn({"run", "tiny_impact", "--steps", "0", "-o", "a.vtkhdf"}, folder.path()).status, 0);
  const TrajectoryReader reader(folder.path() / "a.vtkhdf");
  EXPECT_EQ(reader.frames(), 1);
  EXPECT_EQ(reader.rows(), 0);
  EXPECT_EQ(reader.time(0), 0.0);
}

TEST(Cli, ResumedRunComparesIdentical) {
  const TemporaryFolder folder;
  const Words whole = {"run",     "tiny_impact", "--solver", "reference",
                       "--steps", "40",          "-o",       "whole.vtkhdf"};
  const Words half = {"run",     "tiny_impact", "--solver", "reference",
                      "--steps", "20",          "-o",       "half.vtkhdf"};
  const Words rest = {"run",     "tiny_impact", "--solver", "reference",
                      "--steps", "40",          "--resume", "half.vtkhdf"};
  ASSERT_EQ(run_firn(whole, folder.path()).status, 0);
  ASSERT_EQ(run_firn(half, folder.path()).status, 0);
  const Outcome different = run_firn({"compare", "whole.vtkhdf", "half.vtkhdf"}, folder.path());
  EXPECT_EQ(different.status, 1) << different.out;
  ASSERT_EQ(run_firn(rest, folder.path()).status, 0);
  const Outcome same =
      run_firn({"compare", "whole.vtkhdf", "half.vtkhdf", "--json"}, folder.path());
  EXPECT_EQ(same.status, 0) << same.out;
  EXPECT_TRUE(nlohmann::json::parse(same.out)["identical"].get<bool>());
}

TEST(Cli, InterruptWritesTheLastGoodState) {
  const TemporaryFolder folder;
  // A minute of work and more: it is still running when the signal comes.
  const Outcome outcome =
      run_firn({"run", "snowball_drop", "--solver", "reference", "--until", "2", "-o", "a.vtkhdf"},
               folder.path(), std::chrono::milliseconds(3000));
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  const TrajectoryReader reader(folder.path() / "a.vtkhdf");
  ASSERT_GE(reader.frames(), 1);
  EXPECT_EQ(reader.step(reader.frames() - 1).value_or(-1), reader.rows());
}

/// A lump that falls onto a floor in adaptive semi-implicit steps.
void write_implicit_scene(const std::filesystem::path& path, double tolerance, int max_iterations,
                          double end) {
  std::ofstream(path) << R"(name = "hasty"
gravity = [0.0, 0.0, -9.81]
grid = { spacing = 0.04 }
transfer = { flip = 0.95 }
[time]
max_step = 8e-3
cfl = 0.4
elastic_cfl = 0.5
frames_per_second = 250
end = )" << end << R"(
[integrator]
type = "semi-implicit"
implicitness = 1.0
tolerance = )" << tolerance
                      << R"(
max_iterations = )" << max_iterations
                      << R"(
[[material]]
name = "snow"
youngs_modulus = 1e6
poisson_ratio = 0.2
density = 400.0
hardening = 10.0
critical_compression = 2.5e-2
critical_stretch = 7.5e-3
[[body]]
material = "snow"
shape = { type = "sphere", center = [0.0, 0.0, 0.1], radius = 0.09 }
particles_per_cell = 8
sampling = "jittered"
seed = 9
velocity = [0.0, 0.0, -2.0]
volumes = "estimated"
[[collider]]
shape = { type = "half-space", point = [0.0, 0.0, 0.007], normal = [0.0, 0.0, 1.0] }
friction = 0.3
)";
}

class CliRetries : public testing::TestWithParam<Words> {};

/// 20 iterations do not solve a step of 50 times the explicit limit, but one of a few times.
TEST_P(CliRetries, AStepThatDoesNotConvergeIsHalvedAndReported) {
  const TemporaryFolder folder;
  write_implicit_scene(folder.path() / "hasty.toml", 1e-6, 20, 0.02);
  Words words = {"run", "hasty.toml", "-o", "a.vtkhdf", "--json"};
  words.insert(words.end(), GetParam().begin(), GetParam().end());
  const Outcome outcome = run_firn(words, folder.path());
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  const auto retries = json["retries"].get<std::ptrdiff_t>();
  EXPECT_GT(retries, 0);
  EXPECT_EQ(lines(outcome.err), retries) << outcome.err;  // each one reported
  EXPECT_NE(outcome.err.find("not converged after 20 iterations"), std::string::npos);
  EXPECT_NE(outcome.err.find("attempt 1 with dt"), std::string::npos);
  const TrajectoryReader reader(folder.path() / "a.vtkhdf");
  for (const DiagnosticsRow& row : reader.diagnostics()) {
    EXPECT_LE(row.solver_iterations, 20);
    EXPECT_LE(row.solver_residual, 1e-6);
    EXPECT_EQ(row.solver_iterations > 0, row.solver_residual > 0);
  }
}

/// One iteration never does, not even with a thousandth of the step (it reduces the residual to
/// (cΔt/h)⁴ = 1e-8 there): ten halvings, then exit 3 with the last good state written.
TEST_P(CliRetries, AfterTenHalvingsItGivesUp) {
  const TemporaryFolder folder;
  write_implicit_scene(folder.path() / "hopeless.toml", 1e-13, 1, 0.5);
  Words words = {"run", "hopeless.toml", "-o", "a.vtkhdf", "--json"};
  words.insert(words.end(), GetParam().begin(), GetParam().end());
  const Outcome outcome = run_firn(words, folder.path());
  EXPECT_EQ(outcome.status, 3) << outcome.out;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["status"], "failed");
  EXPECT_GE(json["retries"].get<int>(), 10);
  const TrajectoryReader reader(folder.path() / "a.vtkhdf");
  ASSERT_GE(reader.frames(), 1);
  EXPECT_EQ(reader.step(reader.frames() - 1).value_or(-1), json["step"].get<std::int64_t>());
  EXPECT_EQ(reader.rows(), json["step"].get<std::int64_t>());
}

INSTANTIATE_TEST_SUITE_P(Every, CliRetries,
                         testing::Values(Words{"--solver", "reference"},
                                         Words{"--solver", "optimized"},
                                         Words{"--solver", "optimized", "--precision", "float"}),
                         [](const auto& info) {
                           return info.param.size() > 2 ? std::string("optimized_float")
                                                        : info.param[1];
                         });

TEST(Cli, CheckOfTheOptimizedSolverIsValid) {
  const TemporaryFolder folder;
  for (const char* precision : {"double", "float"}) {
    const Outcome outcome =
        run_firn({"check", "tiny_impact", "--precision", precision, "--steps", "5", "--json"},
                 folder.path());
    EXPECT_EQ(outcome.status, 0) << outcome.out;
    EXPECT_TRUE(nlohmann::json::accept(outcome.out)) << outcome.out;
  }
}

/// A falling ball does not touch the ground: valid, and yet not what was asked for.
TEST(Cli, WhatIsRequiredAndNotExercisedFails) {
  const TemporaryFolder folder;
  const Words words = {"check", "tiny_impact", "--start-step", "0", "--steps", "1"};
  const Outcome valid = run_firn(words, folder.path());
  EXPECT_EQ(valid.status, 0);
  EXPECT_NE(valid.out.find("; not exercised: plastic flow, contact"), std::string::npos);
  Words required = words;
  required.insert(required.end(), {"--require", "volumes,contact"});
  const Outcome lacking = run_firn(required, folder.path());
  EXPECT_EQ(lacking.status, 1);
  EXPECT_NE(lacking.err.find("--require contact"), std::string::npos) << lacking.err;
  EXPECT_EQ(lacking.err.find("--require volumes"), std::string::npos) << lacking.err;
}

TEST(Cli, CheckWithoutASceneComparesTheStandardSet) {
  const TemporaryFolder folder;
  const auto set = nlohmann::json::parse(run_firn({"check", "--json"}, folder.path()).out);
  EXPECT_EQ(set["schema"], "firn-check-set");
  EXPECT_EQ(set["verdict"], "VALID");
  EXPECT_TRUE(set["not_exercised"].empty());
  for (const auto& check : set["checks"]) {
    EXPECT_EQ(check["verdict"], "VALID") << check["scene"];
    // Its command repeats it.
    const std::string scene = check["scene"];
    EXPECT_EQ(check["command"], "firn check " + scene + " --solver optimized --steps 10");
    EXPECT_EQ(run_firn({"check", scene}, folder.path()).status, 0);
  }
  const Outcome wrong = run_firn({"check", "--solver", "mutant:force_sign"}, folder.path());
  EXPECT_EQ(wrong.status, 1);
  EXPECT_NE(wrong.out.find("subject = -1 × reference"), std::string::npos);
}

TEST(Cli, CheckDumpsWhereTheErrorsAre) {
  const TemporaryFolder folder;
  const Outcome dump =
      run_firn({"check", "tiny_impact", "--steps", "2", "--dump", "errors.vtkhdf"}, folder.path());
  EXPECT_EQ(dump.status, 0) << dump.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "errors.vtkhdf"));
  // Again over its own file, but not over another.
  const Words again = {"check", "two_particles", "--start-step", "0", "--dump"};
  Words own = again, foreign = again;
  own.push_back("errors.vtkhdf");
  foreign.push_back("mine.txt");
  std::ofstream(folder / "mine.txt") << "mine";
  EXPECT_EQ(run_firn(own, folder.path()).status, 0);
  EXPECT_EQ(run_firn(foreign, folder.path()).status, 2);
}

TEST(Cli, ACommandThatFailsIsReportedAsTheGuests) {
  const TemporaryFolder folder;
  const Outcome outcome = run_firn(
      {"check", "two_particles", "--solver", "exec:false {in} {out} {steps}"}, folder.path());
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_NE(outcome.out.find("exit status 1"), std::string::npos) << outcome.out;
}

TEST(Cli, ACommandThatHangsIsEnded) {
  const TemporaryFolder folder;
  const Outcome outcome = run_firn({"check", "two_particles", "--time-limit", "1", "--solver",
                                    "exec:sh -c 'sleep 1000' {in} {out} {steps}"},
                                   folder.path());
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_NE(outcome.out.find("within 1 s"), std::string::npos) << outcome.out;
}

/// HDF5 crashes on some damaged files. That is the file's fault, and is said so; what a
/// guest wrote is read in a process of its own.
TEST(Cli, ACrashInsideHdf5IsTheFiles) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer must come before what LD_PRELOAD names";
#endif
  const TemporaryFolder folder;
  ASSERT_EQ(
      run_firn({"run", "tiny_impact", "--steps", "0", "-o", "a.vtkhdf"}, folder.path()).status, 0);
  setenv("LD_PRELOAD", FIRN_CRASH_IN_HDF5, 1);
  const Outcome compare = run_firn({"compare", "a.vtkhdf", "a.vtkhdf"}, folder.path());
  const Outcome resume =
      run_firn({"run", "tiny_impact", "--resume", "a.vtkhdf", "--steps", "2"}, folder.path());
  const Outcome guest =
      run_firn({"check", "two_particles", "--solver", "exec:sh -c 'cp $0 $1' {in} {out} {steps}"},
               folder.path());
  unsetenv("LD_PRELOAD");
  for (const Outcome& outcome : {compare, resume}) {
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err, "firn: a.vtkhdf: is damaged: HDF5 crashes on it\n");
  }
  EXPECT_EQ(guest.status, 1) << guest.err;
  EXPECT_NE(
      guest.out.find("wrote a file that HDF5 cannot handle: its reader ended: killed by signal"),
      std::string::npos)
      << guest.out;
}

}  // namespace
}  // namespace firn::test
