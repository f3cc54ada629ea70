// SPDX-License-Identifier: BSD-3-Clause
/// Guests that break, each in its own way: the report names the guest and what it did
/// in one line, in time, and Firn goes on to say INVALID or to save the last good state.

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <gtest/gtest.h>

#include "io/trajectory/reader.hpp"
#include "verification/support/program.hpp"

namespace firn::test {
namespace {

using fixtures::Outcome;
using fixtures::run_firn;
using fixtures::TemporaryFolder;

struct Fault {
  const char* name;  ///< "place fault" of the library, or the command's fault
  const char* says;  ///< in the report
  int status = 1;    ///< of `firn check`
};

/// GoogleTest's names are letters and digits.
std::string test_name(const testing::TestParamInfo<Fault>& info) {
  std::string name = info.param.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
  return name;
}

std::string line_with(const std::string& text, const std::string& part) {
  const std::size_t at = text.find(part);
  if (at == std::string::npos) return {};
  const std::size_t begin = text.rfind('\n', at) + 1, end = text.find('\n', at);
  return text.substr(begin, end - begin);
}

std::ptrdiff_t lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

/// Where Firn is built with sanitizers, the guest's fault is still the guest's own.
const bool faults_as_they_come = [] {
  return setenv("ASAN_OPTIONS", "handle_segv=0:handle_abort=0:detect_leaks=0", 0) == 0;
}();

/// Runs `firn check` on the guest. Two seconds for each answer where it gives none; else
/// as many as a busy machine may need.
void expect_report(const std::string& guest, const Fault& fault) {
  const TemporaryFolder folder;
  const auto start = std::chrono::steady_clock::now();
  const Outcome outcome =
      run_firn({"check", "two_particles", "--steps", "3", "--time-limit", "2", "--solver", guest},
               folder.path());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(outcome.status, fault.status) << outcome.out << outcome.err;
  // Bad input is told on standard error and nothing else is; a failed check in its table.
  const std::string line = line_with(fault.status == 2 ? outcome.err : outcome.out, fault.says);
  EXPECT_NE(line, "") << fault.says << "\n" << outcome.out << outcome.err;
  EXPECT_NE(line.find("guest "), std::string::npos) << line;
  EXPECT_EQ(line.find('\x1b'), std::string::npos) << line;
  if (fault.status == 2) {
    EXPECT_EQ(outcome.out, "");
  }
  if (fault.status == 1) {
    EXPECT_NE(outcome.out.find("INVALID"), std::string::npos) << outcome.out;
    EXPECT_EQ(line.rfind("first divergence: ", 0), 0u) << line;
  }
  EXPECT_LT(outcome.err.size(), 40000u) << "the guest's own output must have an end";
  EXPECT_LT(took.count(), 25);
  EXPECT_EQ(folder.files(), std::vector<std::string>{}) << "no core, no leftovers";
}

class BrokenLibrary : public testing::TestWithParam<Fault> {};

TEST_P(BrokenLibrary, IsReportedAsTheGuests) {
  setenv("FIRN_BROKEN", GetParam().name, 1);
  expect_report(FIRN_BROKEN_LIBRARY, GetParam());
  unsetenv("FIRN_BROKEN");
}

const Fault library_faults[] = {
    // Before it has said what it can do it is bad input: exit 2.
    {"constructor abort", "killed by signal 6 (Aborted), last line of output: assertion", 2},
    {"constructor hang", "gave no answer within 2 s", 2},
    {"entry segfault", "killed by signal 11", 2},
    {"entry exit", "ended: exit status 0", 2},
    {"entry nothing", "firn_guest_entry() returned NULL", 2},
    {"entry version", "version 99 of the ABI, this is version 1", 2},
    {"entry size", "its struct_size is 8, this version's is", 2},
    {"entry function", "a required function of its table is NULL", 2},
    {"entry stops", "list of stops: got 99", 2},
    {"entry garbage", "broke the protocol: sent something that is not a message", 2},
    {"create null-self", "create() failed", 2},
    {"create segfault", "killed by signal 11", 2},
    {"create print", "gave no answer within 2 s", 2},
    // Later a check has failed: exit 1.
    {"load segfault", "killed by signal 11"},
    {"load refuses", "load() failed: the moon is full\\x0Aand \\x1B[31mthe tide\\xFF is high"},
    {"load refuses-silently", "load() failed: no reason given"},
    {"load huge", "broke the protocol: sent something that is not a message"},
    {"load hang", "gave no answer within 2 s"},
    {"advance null", "killed by signal 11"},
    {"advance stack", "killed by signal 11"},
    {"advance trample", "killed by signal"},
    {"advance abort",
     "killed by signal 6 (Aborted), last line of output: assertion `mass > 0' failed"},
    {"advance exit", "ended: exit status 0"},
    {"advance hang", "gave no answer within 2 s"},
    {"advance spin", "gave no answer within 2 s"},
    {"advance print", "gave no answer within 2 s"},
    {"advance close", "the channel was closed"},
    {"advance garbage", "sent something that is not a message"},
    {"advance refuses", "advance_through() failed: the moon is full"},
    {"advance collider", "last line of output: guest asked for collider 77 of 0"},
    {"count too-many", "at most 64 per particle are possible"},
    {"store segfault", "killed by signal 11"},
    {"store nothing", "store() left next_stage at 0"},
    {"store stage", "store() left next_stage at 77"},
    {"store material", "gave a particle a material that does not exist"},
};

INSTANTIATE_TEST_SUITE_P(All, BrokenLibrary, testing::ValuesIn(library_faults), test_name);

class BrokenCommand : public testing::TestWithParam<Fault> {};

TEST_P(BrokenCommand, IsReportedAsTheGuests) {
  expect_report(
      std::string("exec:" FIRN_BROKEN_COMMAND " ") + GetParam().name + " {in} {out} {steps}",
      GetParam());
}

const Fault command_faults[] = {
    {"segfault", "ended: killed by signal 11"},
    {"abort", "killed by signal 6 (Aborted), last line of output: terminate called"},
    {"exit", "ended: exit status 3"},
    {"early", "wrote no file at {out}"},
    {"words", "exit status 1, last line of output: ValueError: mass is \\x1B[31mnegative"},
    {"hang", "did not end within 2 s"},
    {"spin", "did not end within 2 s"},
    {"print", "did not end within 2 s"},
    {"empty", "wrote no trajectory: {out}: is not a readable HDF5 file"},
    {"text", "wrote no trajectory: {out}: is not a readable HDF5 file"},
    {"half", "wrote no trajectory: {out}: is not a readable HDF5 file"},
    {"noise", " wrote "},
    {"directory", "wrote something at {out} that is not a file"},
    {"pipe", "wrote something at {out} that is not a file"},
    {"endless", "killed by signal 25 (File size limit exceeded)"},
    {"clear", "wrote no file at {out}"},
    {"ids", "returned the particles with other ids or in another order"},
    {"fewer", "1 particles instead of 2"},
    {"more", "rows of frame 0: got 99"},
    {"plane", "velocity: shape: got (2,2), allowed: (N,3)"},
    {"integers", "mass: type: got integer of 4 bytes"},
    {"missing", "F_P: missing dataset"},
};

INSTANTIATE_TEST_SUITE_P(All, BrokenCommand, testing::ValuesIn(command_faults), test_name);

TEST(BrokenGuest, LibraryThatIsNone) {
  expect_report(FIRN_NO_ENTRY, {"", "it does not export firn_guest_entry()", 2});
  expect_report(FIRN_BROKEN_COMMAND, {"", "cannot dynamically load", 2});
  expect_report(FIRN_TEXT_FILE, {"", "invalid ELF header", 2});
}

/// Wrong numbers are no fault of the protocol: `check` names the particle.
TEST(BrokenGuest, NotANumberIsNamedWithItsParticle) {
  const TemporaryFolder folder;
  const std::string command = "exec:" FIRN_BROKEN_COMMAND " nan {in} {out} {steps}";
  setenv("FIRN_BROKEN", "store nan", 1);
  for (const std::string& guest : {std::string(FIRN_BROKEN_LIBRARY), command}) {
    const Outcome outcome = run_firn({"check", "two_particles", "--solver", guest}, folder.path());
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_NE(outcome.out.find("INVALID"), std::string::npos) << outcome.out;
    const Outcome run =
        run_firn({"run", "two_particles", "--solver", guest, "-o", "a.vtkhdf"}, folder.path());
    EXPECT_EQ(run.status, 3) << run.err;
    EXPECT_EQ(lines(run.err), 1) << run.err;
    EXPECT_NE(run.err.find("returned x of particle 1 that is not finite"), std::string::npos)
        << run.err;
    EXPECT_EQ(TrajectoryReader(folder.path() / "a.vtkhdf").frames(), 1) << "the last good state";
  }
  unsetenv("FIRN_BROKEN");
}

/// `firn run` with a guest that fails: exit 3, one line, the last good state in the file.
TEST(BrokenGuest, RunSavesTheLastGoodState) {
  for (const char* fault : {"advance segfault", "advance hang", "advance refuses", "store stage"}) {
    SCOPED_TRACE(fault);
    const TemporaryFolder folder;
    setenv("FIRN_BROKEN", fault, 1);
    const Outcome outcome = run_firn({"run", "two_particles", "--time-limit", "2", "--solver",
                                      FIRN_BROKEN_LIBRARY, "-o", "a.vtkhdf"},
                                     folder.path());
    unsetenv("FIRN_BROKEN");
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    EXPECT_EQ(lines(outcome.err), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("guest "), std::string::npos) << outcome.err;
    EXPECT_EQ(TrajectoryReader(folder.path() / "a.vtkhdf").frames(), 1);
  }
}

/// What a sound guest prints is no answer, and reading standard input gives nothing.
TEST(BrokenGuest, TalkIsHarmless) {
  const TemporaryFolder folder;
  setenv("FIRN_CHATTY", "1", 1);
  const Outcome library = run_firn({"run", "two_particles", "--steps", "5", "--solver",
                                    FIRN_BROKEN_LIBRARY, "-o", "a.vtkhdf", "--json"},
                                   folder.path());
  unsetenv("FIRN_CHATTY");
  EXPECT_EQ(library.status, 0) << library.err;
  EXPECT_EQ(library.out.front(), '{') << library.out;
  EXPECT_NE(library.err.find("this line is no answer"), std::string::npos) << library.err;
  for (const char* fault : {"stdin", "leftover", "none"}) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome command =
        run_firn({"run", "two_particles", "--steps", "2", "--time-limit", "10", "--solver",
                  std::string("exec:" FIRN_BROKEN_COMMAND " ") + fault + " {in} {out} {steps}",
                  "-o", "b.vtkhdf"},
                 folder.path());
    EXPECT_EQ(command.status, 0) << fault << command.err;
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10)) << fault;
  }
}

}  // namespace
}  // namespace firn::test
