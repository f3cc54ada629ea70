/// A run measures what is missing, keeps what is done, and says what is wrong.

#include <csignal>
#include <filesystem>
#include <gtest/gtest.h>
#include <sstream>
#include <unistd.h>

#include "bench/bench.hpp"
#include "bench/timing.hpp"
#include "cli/builtin_solvers.hpp"
#include "firn/error.hpp"

namespace firn::bench {
namespace {

namespace fs = std::filesystem;

class RunnerTest : public ::testing::Test {
 protected:
  RunnerTest() {
    cli::register_builtin_solvers(registry);
    registry.add({"liar", "gravity forgotten, say", {Precision::float64}, false, make_liar});
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
    cli::register_builtin_solvers(honest);
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
  options.suites = {"roofline/fma_float,1T"};
  EXPECT_EQ(run_it(), 0);
  EXPECT_NE(log.str().find("[1/1] roofline/fma_float,1T: "), std::string::npos);
  const bool noisy = log.str().find("noisy") != std::string::npos;
  EXPECT_EQ(run_it(), 0);
  EXPECT_EQ(log.str().find("[1/1]") == std::string::npos, !noisy) << log.str();
}

TEST_F(RunnerTest, AWrongSolverIsNotTimed) {
  results::Case result;
  validate(registry, {"liar", Precision::float64, 1}, Deformation::elastic, 1, result);
  EXPECT_EQ(result.status, results::Status::invalid);
  results::Case honest;
  validate(registry, {"reference", Precision::float64, 1}, Deformation::elastic, 1, honest);
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

TEST_F(RunnerTest, ListingMeasuresNothing) {
  options.list = true;
  EXPECT_EQ(run_it(), 0);
  EXPECT_NE(out.str().find("steps/reference,double,1T,plastic,100000"), std::string::npos);
  EXPECT_FALSE(fs::exists(options.output));
}

TEST_F(RunnerTest, AnUnknownSuiteIsRefused) {
  options.suites = {"nonsense"};
  EXPECT_THROW(run_it(), InputError);
}

}  // namespace
}  // namespace firn::bench
