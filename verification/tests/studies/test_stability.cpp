// SPDX-License-Identifier: BSD-3-Clause
/// The bisection of the stability study finds the limits that the theory predicts.

#include <cmath>
#include <gtest/gtest.h>

#include "firn/error.hpp"
#include "verification/studies/stability.hpp"
#include "verification/support/ballistic_solver.hpp"
#include "verification/support/builtin_registry.hpp"

namespace firn::studies {
namespace {

/// The largest stable step over the one from which the predicted growth is seen.
double measured_over_expected(const StabilityPoint& point) {
  const Subject subject{[] { return fixtures::builtin_registry().create("optimized", {}); }};
  const double seen = std::pow(burst_growth(subject.precision), 1.0 / stability_steps);
  return largest_stable(subject, point).cfl / predicted_cfl(point, seen);
}

TEST(Stability, BulkLimitIsWhereItIsPredicted) {
  const StabilityPoint point;  // α = 0.95
  EXPECT_NEAR(predicted_cfl(point), 1.498, 0.002);
  EXPECT_NEAR(measured_over_expected(point), 1, 0.01);  // the bisection ends within 0.6 %
}

/// S = ΣN'²/N and V/V_full = (ΣN²)⁻³ by hand: on a node N = 1/6, 2/3, 1/6, N' = ½, 0, ½,
/// S = 3, V = 8 h³; in the middle of a cell N = 1/48, 23/48, twice, S = 3.1304, V = 10.27 h³.
TEST(Stability, ALoneParticleIsLimitedByItsOwnVolume) {
  const double modulus = 2.0 / 3;  // (λ+2μ)/(2μ+3λ) at ν = 0.2: λ = E/3.6, μ = E/2.4
  const auto limit = [&](double S, double V) { return std::sqrt(2 * modulus / (S * V)); };
  const struct {
    bool estimated;
    double place, predicted;
  } rows[] = {{false, 0, limit(3, 1)},
              {true, 0, limit(3, 8)},
              {true, 0.5, limit(2 * (0.75 + 18.75 / 23), std::pow(2304.0 / 1060, 3))}};
  for (const auto& row : rows) {
    StabilityPoint point;
    point.lone = true;
    point.per_edge = 1;
    point.place = row.place;
    point.estimated = row.estimated;
    EXPECT_NEAR(predicted_cfl(point), row.predicted, 1e-12);
    EXPECT_NEAR(measured_over_expected(point), 1, 0.015);  // the bisection ends within 1 %
  }
}

/// A solver that fails before anything has grown has not been found unstable.
TEST(Stability, AFailureIsNotABurst) {
  const auto failing = [](std::int64_t at_step) {
    return Subject{[at_step] {
      auto solver = std::make_unique<fixtures::BallisticSolver>();
      solver->failure = [at_step](std::int64_t step, double) {
        if (step == at_step)
          throw SimulationError(Stage::rasterize, SimulationError::Subject::solver, -1, "no");
      };
      return solver;
    }};
  };
  StabilityPoint point;
  EXPECT_THROW(stable(failing(0), point, 1.0), SimulationError);
  // A semi-implicit solve that does not converge is the limit itself.
  point.beta = 1;
  EXPECT_FALSE(stable(failing(0), point, 1.0));
}

}  // namespace
}  // namespace firn::studies
