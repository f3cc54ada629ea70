// SPDX-License-Identifier: BSD-3-Clause
/// A run measures what is missing, keeps what is done, and says what is wrong.

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <sstream>
#include <sys/wait.h>
#include <unistd.h>

#include "bench/bench.hpp"
#include "bench/statistics.hpp"
#include "bench/timing.hpp"
#include "firn/error.hpp"
#include "io/hdf5/read.hpp"
#include "solvers/solvers.hpp"

namespace firn::bench {
namespace {

namespace fs = std::filesystem;

class RunnerTest : public ::testing::Test {
 protected:
  RunnerTest() {
    register_solvers(registry);
    registry.add({"liar", "gravity forgotten, say", {Precision::float64}, make_liar});
    options.output =
        (fs::temp_directory_path() / ("firn_bench_" + std::to_string(getpid()) + ".h5")).string();
    fs::remove(options.output);
  }
  ~RunnerTest() override { fs::remove(options.output); }

  /// A reference that moves its particles a millionth too far.
  class Liar : public Solver {
   public:
    explicit Liar(std::unique_ptr<Solver> honest) : honest_(std::move(honest)) {}
    const SolverTraits& traits() const override { return honest_->traits(); }
    void load(const Scene& scene, const State& state) override { honest_->load(scene, state); }
    TimeStep choose_time_step() override { return honest_->choose_time_step(); }
    StepReport advance_through(Stage last, double dt) override {
      return honest_->advance_through(last, dt);
    }
    void store(State& state) const override {
      honest_->store(state);
      state.particles.x[7] *= 1 + 1e-6;
    }

   private:
    std::unique_ptr<Solver> honest_;
  };
  static std::unique_ptr<Solver> make_liar(const SolverOptions& options) {
    Registry honest;
    register_solvers(honest);
    return std::make_unique<Liar>(honest.create("reference", options));
  }

  int run_it() {
    log.str("");
    return run(registry, options, out, log);
  }

  Registry registry;
  Options options;
  std::ostringstream out, log;
};

TEST_F(RunnerTest, WhatIsDoneIsNotMeasuredAgain) {
  options.suites = {"roofline/fma_float,1*"};
  EXPECT_EQ(run_it(), 0);
  EXPECT_NE(log.str().find("[1/1] roofline/fma_float,1T: "), std::string::npos);
  const bool noisy = log.str().find("noisy") != std::string::npos;
  EXPECT_EQ(run_it(), 0);
  EXPECT_EQ(log.str().find("[1/1]") == std::string::npos, !noisy) << log.str();
  options.again = true;
  EXPECT_EQ(run_it(), 0);
  EXPECT_NE(log.str().find("[1/1]"), std::string::npos) << log.str();
}

/// The page prints SUITE/CASE beside a number: it must be measured whatever file is there.
TEST_F(RunnerTest, ACaseNamedByItselfIsMeasuredAgain) {
  options.suites = {"stress/no particle,reference,double,1T"};
  for (int turn = 0; turn < 2; ++turn) {
    EXPECT_EQ(run_it(), 0);
    EXPECT_NE(log.str().find("[1/1]"), std::string::npos) << log.str();
  }
}

/// Four times the repetitions of the same spread: half the error.
TEST(MedianError, ShrinksWithRepetitionsAndIsUnknownOfTwo) {
  EXPECT_TRUE(std::isinf(median_error({1, 1})));
  EXPECT_EQ(median_error({2, 2, 2}), 0);
  std::vector<double> values = {1, 2, 3, 4, 5, 6, 7};  // quartiles 2.5 and 5.5, median 4
  const double once = median_error(values);
  EXPECT_NEAR(once, 1.25 / 1.35 * 0.75 / std::sqrt(7), 1e-15);
  const std::vector<double> copy = values;
  for (int i = 0; i < 3; ++i) values.insert(values.end(), copy.begin(), copy.end());
  EXPECT_NEAR(median_error(values) / once, 0.5 * (6.0 - 2.0) / (5.5 - 2.5), 1e-12);
}

TEST_F(RunnerTest, AWrongSolverIsNotTimed) {
  results::Case result;
  validate(registry, {"liar", Precision::float64, 1}, Deformation::elastic, 1, result);
  EXPECT_EQ(result.status, results::Status::invalid);
  results::Case honest;
  validate(registry, {"reference"}, Deformation::elastic, 1, honest);
  EXPECT_EQ(honest.status, results::Status::measured) << honest.validation;
}

TEST_F(RunnerTest, AnInterruptEndsTheRunWith130AndKeepsTheFile) {
  options.suites = {"roofline/fma_*"};
  struct RaiseOnOutput : std::stringbuf {
    int sync() override {
      std::raise(SIGINT);  // as the first case is announced
      return 0;
    }
  } buffer;
  std::ostream stream(&buffer);
  EXPECT_EQ(run(registry, options, out, stream), 130);
  EXPECT_TRUE(fs::exists(options.output));
  EXPECT_EQ(run_it(), 0);
}

/// Names of the cases that `log` announces as measured.
std::vector<std::string> measured(const std::string& log) {
  std::vector<std::string> names;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);)
    if (const std::size_t end = line.find(": "); line.rfind("[", 0) == 0)
      names.push_back(line.substr(line.find("] ") + 2, end - line.find("] ") - 2));
  return names;
}

/// kill -9 in the middle of a run: what was reported as measured is in the file, and the
/// next run measures the rest.
TEST_F(RunnerTest, AKilledRunIsCompletedByTheNext) {
  options.suites = {"stress"};
  options.solvers = {"reference", "optimized"};
  const std::string log_file = options.output + ".log";
  const pid_t child = fork();
  if (child == 0) {
    std::ofstream child_log(log_file);
    run(registry, options, out, child_log);
    pause();
    _exit(0);
  }
  ASSERT_GT(child, 0);
  std::vector<std::string> before;
  for (int tries = 0; tries < 4000 && before.size() < 4; ++tries) {
    std::ifstream file(log_file);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    before = measured(text);
    usleep(2000);
  }
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  std::ifstream file(log_file);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  before = measured(text);
  fs::remove(log_file);
  ASSERT_GE(before.size(), 4u) << text;
  before.pop_back();  // announced, perhaps not finished
  EXPECT_EQ(run_it(), 0) << log.str();
  const std::vector<std::string> after = measured(log.str());
  for (const std::string& name : before)
    EXPECT_EQ(std::count(after.begin(), after.end(), name), 0) << name;
  EXPECT_EQ(run_it(), 0);
  EXPECT_TRUE(measured(log.str()).empty()) << log.str();
}

/// What failed its validation leaves no number behind, neither in the file nor in the log.
TEST_F(RunnerTest, NoNumberOfAWrongSolverIsPrinted) {
  options.solvers = {"liar"};
  options.suites = {"steps/liar,double,1T,elastic,100000"};
  EXPECT_EQ(run_it(), 1);
  EXPECT_NE(log.str().find("invalid: differs from the reference"), std::string::npos) << log.str();
  EXPECT_EQ(log.str().find(" ns"), std::string::npos) << log.str();
  const hdf5::InputFile file(options.output);
  const std::string group = "cases/steps/liar,double,1T,elastic,100000/quantities";
  EXPECT_TRUE(file.has(group));
  EXPECT_TRUE(file.children(group).empty());
}

TEST_F(RunnerTest, EverySituationUnderStressEndsAsExpected) {
  options.suites = {"stress"};
  options.solvers = {"reference", "optimized"};
  EXPECT_EQ(run_it(), 0) << log.str();
}

TEST_F(RunnerTest, ListingMeasuresNothing) {
  options.list = true;
  EXPECT_EQ(run_it(), 0);
  EXPECT_NE(out.str().find("steps/reference,double,1T,plastic,100000"), std::string::npos);
  EXPECT_FALSE(fs::exists(options.output));
}

TEST_F(RunnerTest, AStarStandsForAnythingAnywhere) {
  options.list = true;
  options.suites = {"stress/*,reference*", "implicit/cost,*r=10,*"};
  EXPECT_EQ(run_it(), 0);
  std::istringstream lines(out.str());
  int stress = 0, implicit = 0, all = 0;
  for (std::string line; std::getline(lines, line); ++all) {
    stress += line.rfind("stress/", 0) == 0 && line.find(",reference,") != std::string::npos;
    implicit += line.rfind("implicit/cost,", 0) == 0 && line.find(",r=10,") != std::string::npos;
  }
  EXPECT_EQ(stress, 18);
  EXPECT_GE(implicit, 9);
  EXPECT_EQ(stress + implicit, all);
}

TEST_F(RunnerTest, AnUnknownSuiteIsRefused) {
  options.suites = {"nonsense"};
  EXPECT_THROW(run_it(), InputError);
}

}  // namespace
}  // namespace firn::bench
