// SPDX-License-Identifier: BSD-3-Clause
/// Guests, mutants and exercises come through one door: every verb that takes a solver takes them.

#include <gtest/gtest.h>

#include "verification/support/program.hpp"

namespace firn::test {
namespace {

/// Measured like any other solver, and told from the others by the library's file name.
TEST(EveryVerb, BenchMeasuresAGuest) {
  const TemporaryFolder folder;
  const Outcome outcome = run_firn({"bench", "float/creep,libexample_guest.so,double,1T",
                                    "--solver", FIRN_EXAMPLE_LIBRARY, "-o", "bench.h5"},
                                   folder.path());
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_NE(outcome.err.find("1 measured now"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(" 0 of them invalid or failed"), std::string::npos) << outcome.err;
}

/// Cases are planned in the precision that a guest has, and a command without stages has none
/// of the kernels.
TEST(EveryVerb, BenchPlansWhatASolverCanDo) {
  const TemporaryFolder folder;
  const auto list = [&](const std::string& solver) {
    const Outcome outcome = run_firn({"bench", "--list", "--solver", solver}, folder.path());
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out;
  };
  const std::string guest = list(FIRN_EXAMPLE_LIBRARY), mutant = list("mutant:force_sign"),
                    command = list("exec:cp {in} {out} {steps}");
  EXPECT_NE(guest.find("steps/libexample_guest.so,double,1T"), std::string::npos) << guest;
  EXPECT_EQ(guest.find("libexample_guest.so,float"), std::string::npos) << guest;
  EXPECT_NE(mutant.find("kernels/collision,mutant:force_sign,double"), std::string::npos) << mutant;
  EXPECT_NE(command.find("steps/exec:cp__in___out___steps_,float"), std::string::npos) << command;
  EXPECT_EQ(command.find("kernels/collision,exec"), std::string::npos) << command;
}

TEST(EveryVerb, BenchRefusesASolverThatDoesNotExist) {
  const TemporaryFolder folder;
  const Outcome outcome = run_firn({"bench", "--list", "--solver", "optimised"}, folder.path());
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("--solver: unknown solver: got optimised, allowed: reference, "
                             "optimized, mutant:NAME, exercise:NUMBER"),
            std::string::npos)
      << outcome.err;
}

/// A guest against a mutant: `--against` is a solver like any other.
TEST(EveryVerb, CheckTakesAnyTwo) {
  const TemporaryFolder folder;
  const auto check = [&](const std::string& against) {
    return run_firn({"check", "tiny_impact", "--start-step", "100", "--steps", "2", "--solver",
                     "reference", "--against", against},
                    folder.path());
  };
  EXPECT_EQ(check("exercise:4").status, 1) << check("exercise:4").out;
  EXPECT_EQ(check("optimized").status, 0) << check("optimized").out;
  EXPECT_EQ(check("mutant:none_of_that_name").status, 2);
}

}  // namespace
}  // namespace firn::test
