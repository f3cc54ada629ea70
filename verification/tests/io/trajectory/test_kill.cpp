// SPDX-License-Identifier: BSD-3-Clause
/// A run is killed before every single call that changes a file, one run per
/// call. Whatever is left must open plainly and hold every frame that was
/// reported, and continuing must lead to the file of the run that nobody killed.

#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <spawn.h>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "io/hdf5/read.hpp"
#include "io/trajectory/reader.hpp"
#include "simulation/simulate.hpp"
#include "verification/support/ballistic_solver.hpp"
#include "verification/support/same_state.hpp"
#include "verification/support/temporary_folder.hpp"
#include "verification/tests/io/trajectory/kill_scenes.hpp"

extern char** environ;

namespace firn {
namespace {

using fixtures::BallisticSolver;
using fixtures::kill_scene;
using fixtures::same_particles;
using fixtures::TemporaryFolder;

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

struct Frame {
  std::int64_t frame, step;
};

struct Outcome {
  int status = 0;  ///< as waitpid() gives it
  std::vector<Frame> reported;

  bool killed() const { return WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL; }
};

/// Runs kill_run under the shim with these additions to the environment.
Outcome run_kill_run(const std::vector<std::string>& arguments,
                     const std::vector<std::string>& settings) {
  std::vector<std::string> texts = {FIRN_KILL_RUN};
  texts.insert(texts.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& text : texts) argv.push_back(text.data());
  argv.push_back(nullptr);

  std::vector<std::string> variables = settings;
  variables.push_back("LD_PRELOAD=" FIRN_KILL_SHIM);
  variables.push_back("ASAN_OPTIONS=verify_asan_link_order=0");  // the shim comes first
  std::vector<char*> env;
  for (std::string& variable : variables) env.push_back(variable.data());
  for (char** variable = environ; *variable != nullptr; ++variable) env.push_back(*variable);
  env.push_back(nullptr);

  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  pid_t child = 0;
  const int error = posix_spawn(&child, FIRN_KILL_RUN, &actions, nullptr, argv.data(), env.data());
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (error != 0) throw std::runtime_error("cannot start " FIRN_KILL_RUN);

  std::string output;
  char buffer[4096];
  for (ssize_t n = 0; (n = read(ends[0], buffer, sizeof buffer)) > 0;)
    output.append(buffer, static_cast<std::size_t>(n));
  close(ends[0]);
  Outcome outcome;
  waitpid(child, &outcome.status, 0);
  // Only whole lines: the last one may itself have been cut off.
  std::istringstream lines(output.substr(0, output.rfind('\n') + 1));
  for (Frame frame; lines >> frame.frame >> frame.step;) outcome.reported.push_back(frame);
  return outcome;
}

/// The names of all calls that a run makes.
std::vector<std::string> calls_of(const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const auto log = folder / "calls";
  const Outcome outcome = run_kill_run(arguments, {"FIRN_KILL_LOG=" + log.string()});
  EXPECT_EQ(outcome.status, 0);
  std::ifstream in(log);
  return {std::istream_iterator<std::string>(in), {}};
}

void run_here(const Scene& scene, const std::filesystem::path& output,
              const std::filesystem::path& resume) {
  BallisticSolver solver;
  RunOptions options;
  options.output = output;
  options.resume = resume;
  ASSERT_EQ(simulate(scene, solver, options).exit_status(), 0);
}

/// The uninterrupted run, read once.
class Whole {
 public:
  explicit Whole(const std::filesystem::path& path) : bytes(bytes_of(path)) {
    const TrajectoryReader reader(path);
    rows = reader.diagnostics();
    for (std::int64_t k = 0; k < reader.frames(); ++k) {
      states[*reader.step(k)] = reader.read_frame(k);
      restarts[*reader.step(k)] = reader.restart(k);
    }
  }
  std::string bytes;
  std::vector<DiagnosticsRow> rows;
  std::map<std::int64_t, State> states;
  std::map<std::int64_t, std::vector<std::byte>> restarts;
};

/// The file holds all that was reported, and nothing wrong.
void judge(const std::filesystem::path& path, const std::vector<Frame>& reported,
           const Whole& whole, bool torn) {
  if (!std::filesystem::exists(path)) {
    EXPECT_TRUE(reported.empty()) << "a frame was reported, and there is no file";
    return;
  }
  const TrajectoryReader reader(path);
  for (const Frame& frame : reported) {
    ASSERT_LT(frame.frame, reader.frames()) << "a reported frame is lost";
    EXPECT_EQ(*reader.step(frame.frame), frame.step);
  }
  for (std::int64_t k = 0; k < reader.frames(); ++k) {
    const std::int64_t step = *reader.step(k);
    ASSERT_TRUE(whole.states.count(step)) << "a frame of step " << step;
    const State expected = whole.states.at(step), found = reader.read_frame(k);
    EXPECT_EQ(found.time, expected.time);
    EXPECT_TRUE(same_particles(found.particles, expected.particles)) << "frame " << k;
    EXPECT_EQ(reader.restart(k), whole.restarts.at(step));
    EXPECT_GE(reader.rows(), step);
  }
  const std::vector<DiagnosticsRow> rows = reader.diagnostics();
  ASSERT_LE(rows.size(), whole.rows.size());
  for (std::size_t n = 0; n < rows.size(); ++n) {
    EXPECT_EQ(rows[n].time, whole.rows[n].time);
    EXPECT_EQ(rows[n].momentum, whole.rows[n].momentum);
  }
  // VTK's reader copies all of Steps/Values into NSteps places; one that is cut off in the middle
  // of that very write (352 bytes in one page, so no system does it) may be one short.
  const hdf5::InputFile file(path);
  const std::int64_t times = file.dataset("/VTKHDF/Steps/Values", hdf5::Kind::real, 1).rows();
  const std::int64_t counted = file.integer_attribute("/VTKHDF/Steps", "NSteps");
  EXPECT_TRUE(times == counted || (torn && times == counted - 1))
      << times << " times of " << counted << " frames";
}

void expect_no_partial_file(const TemporaryFolder& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    EXPECT_EQ(entry.path().extension(), ".vtkhdf") << entry.path();
}

struct KillCase {
  const char* name;
  const char* scene;
  bool torn;            ///< half of the write that is interrupted still happens
  const char* prepare;  ///< the run that is killed continues one of so many steps; null: a new run
};

void PrintTo(const KillCase& c, std::ostream* out) { *out << c.name; }

class KillAtEveryWrite : public ::testing::TestWithParam<KillCase> {};

TEST_P(KillAtEveryWrite, LosesNothingThatWasReported) {
  const KillCase& c = GetParam();
  const Scene scene = kill_scene(c.scene);
  const TemporaryFolder folder(true);
  const auto whole_path = folder / "whole.vtkhdf", path = folder / "killed.vtkhdf",
             begun = folder / "begun.vtkhdf";
  run_here(scene, whole_path, {});
  const Whole whole(whole_path);
  std::vector<std::string> arguments = {c.scene, path.string()};
  std::vector<Frame> reported_before;
  if (c.prepare != nullptr) {
    reported_before = run_kill_run({c.scene, begun.string(), "steps", c.prepare}, {}).reported;
    std::filesystem::copy_file(begun, path);
    arguments.insert(arguments.end(), {"resume", path.string()});
  }

  const std::vector<std::string> calls = calls_of(arguments);
  ASSERT_GT(calls.size(), 100u) << "the shim does not see the writes";
  std::size_t kills = 0;
  for (std::size_t n = 1; n <= calls.size(); ++n) {
    if (c.torn && calls[n - 1] != "pwrite") continue;
    SCOPED_TRACE("killed in call " + std::to_string(n) + " of " + std::to_string(calls.size()) +
                 ", " + calls[n - 1]);
    std::filesystem::remove(path);
    if (c.prepare != nullptr) std::filesystem::copy_file(begun, path);
    std::vector<std::string> settings = {"FIRN_KILL_AT=" + std::to_string(n)};
    if (c.torn) settings.push_back("FIRN_KILL_TORN=1");
    Outcome outcome = run_kill_run(arguments, settings);
    ASSERT_TRUE(outcome.killed()) << "status " << outcome.status;
    ++kills;
    if (c.prepare != nullptr)
      outcome.reported.insert(outcome.reported.begin(), reported_before.begin(),
                              reported_before.end());
    judge(path, outcome.reported, whole, c.torn);
    run_here(scene, path, std::filesystem::exists(path) ? path : "");
    EXPECT_TRUE(bytes_of(path) == whole.bytes) << "the continued run is another one";
    expect_no_partial_file(folder);
    if (HasFailure()) break;
  }
  RecordProperty("kills", static_cast<int>(kills));
}

INSTANTIATE_TEST_SUITE_P(Runs, KillAtEveryWrite,
                         ::testing::Values(KillCase{"fixed", "fixed", false, nullptr},
                                           KillCase{"fixed_torn", "fixed", true, nullptr},
                                           KillCase{"growing", "adaptive", false, nullptr},
                                           // Step 8 has a frame of its own accord.
                                           KillCase{"resumed", "fixed", false, "8"}),
                         [](const auto& info) { return info.param.name; });

TEST(KillAtEveryWrite, ItsGrowingRunGrowsAndShrinks) {
  const TemporaryFolder folder;
  const auto calls = calls_of({"adaptive", (folder / "out.vtkhdf").string()});
  // Taking the output's place, once for each: first frame, more rows, final size.
  EXPECT_GE(std::count(calls.begin(), calls.end(), "rename"), 3);
}

}  // namespace
}  // namespace firn
