/// The closed forms are solutions, and the reference converges to them.

#include <cmath>
#include <gtest/gtest.h>

#include "bench/exact.hpp"
#include "bench/suites.hpp"
#include "cli/builtin_solvers.hpp"

namespace firn::bench {
namespace {

double error_of(const ExactProblem& problem) {
  Registry registry;
  cli::register_builtin_solvers(registry);
  const auto solver = registry.create("reference", {});
  State state = problem.initial;
  solver->load(problem.scene, state);
  for (int step = 0; step < problem.steps; ++step) {
    if (problem.body_force) {
      solver->store(state);
      for (std::size_t p = 0; p < problem.X.size(); ++p)
        state.particles.v[p] +=
            problem.scene.time.step * problem.body_force(problem.X[p], state.time);
      solver->load(problem.scene, state);
    }
    solver->step(problem.scene.time.step);
  }
  solver->store(state);
  return problem.relative_error(state);
}

double order(double coarse, double fine) { return std::log2(coarse / fine); }

const AlphaPolicy undamped{"1", 1, false}, pic{"0", 0, false};

TEST(Exact, StandingWaveConvergesWithSecondOrder) {
  const double e16 = error_of(standing_wave(16, 0.4, undamped));
  const double e32 = error_of(standing_wave(32, 0.4, undamped));
  EXPECT_GE(order(e16, e32), 1.9) << e16 << " " << e32;
}

TEST(Exact, StandingWaveOfPicConvergesWithFirstOrder) {
  const double e32 = error_of(standing_wave(32, 0.5, pic));
  const double e64 = error_of(standing_wave(64, 0.5, pic));
  // From 32 to 64 cells the damping, not the error, is of first order: 1 − e^{−a h}.
  EXPECT_NEAR(order(e32, e64), 0.9, 0.25) << e32 << " " << e64;
}

TEST(Exact, ManufacturedSolutionConvergesWithSecondOrder) {
  const double e8 = error_of(manufactured(8, 0.4, undamped));
  const double e16 = error_of(manufactured(16, 0.4, undamped));
  EXPECT_GE(order(e8, e16), 1.8) << e8 << " " << e16;
}

TEST(Exact, ColumnConvergesWithFirstOrder) {
  const double e8 = error_of(column(8, 0.4, pic)), e16 = error_of(column(16, 0.4, pic));
  EXPECT_NEAR(order(e8, e16), 1.0, 0.15) << e8 << " " << e16;
}

TEST(Exact, DampingPerTimeDoesNotKnowTheStep) {
  const AlphaPolicy rate{"rate", 0, true};
  EXPECT_NEAR((1 - rate.alpha(1e-4)) / (1 - rate.alpha(1e-5)), 10, 1e-9);
  EXPECT_NEAR(rate.alpha(0.4 / 16 / std::sqrt(1.4e5 * 10 / 9 / 400)), 0.95, 1e-6);
}

/// The bisection finds the predicted bulk limit within 3 %.
TEST(Stability, BulkLimitIsWhereItIsPredicted) {
  Registry registry;
  cli::register_builtin_solvers(registry);
  Options options;
  std::vector<CasePlan> plans;
  plan_stability_suite(registry, options, plans);
  for (CasePlan& plan : plans) {
    if (plan.description.name != "reference,double,1T,alpha=0.95") continue;
    plan.run(plan.description);
    const auto& q = plan.description.quantities;
    ASSERT_EQ(q.size(), 3u);
    EXPECT_NEAR(q[2].values[0], 1.498, 0.002) << "prediction";
    EXPECT_NEAR(q[0].values[0] / q[2].values[0], 1, 0.03) << "measured " << q[0].values[0];
    return;
  }
  FAIL() << "no such case";
}

}  // namespace
}  // namespace firn::bench
