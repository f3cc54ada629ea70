// SPDX-License-Identifier: BSD-3-Clause
/// The blocks that are timed do what their names say.

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "bench/probes.hpp"
#include "bench/statistics.hpp"
#include "bench/timing.hpp"
#include "bench/workload.hpp"
#include "verification/support/builtin_registry.hpp"

namespace firn::bench {
namespace {

/// Particles whose F_P moved in the last of `steps` steps.
std::size_t yielding(Deformation deformation, int steps) {
  const Workload work = block(1000, deformation, 3);
  const auto solver = fixtures::make_reference();
  solver->load(work.scene, work.state);
  State before, after;
  for (int i = 0; i < steps; ++i) {
    solver->store(before);
    solver->step(work.scene.time.step);
  }
  solver->store(after);
  std::size_t count = 0;
  for (std::size_t p = 0; p < after.particles.size(); ++p)
    count += (after.particles.F_P[p] - before.particles.F_P[p]).norm() > 1e-6;
  return count;
}

TEST(Workload, EveryParticleYieldsToTheEndOfThePlasticOne) {
  EXPECT_EQ(yielding(Deformation::plastic, 1), 1000u);
  EXPECT_EQ(yielding(Deformation::plastic, block(8, Deformation::plastic, 1).steps_allowed), 1000u);
}

TEST(Workload, NoParticleYieldsInTheElasticOne) {
  EXPECT_EQ(yielding(Deformation::elastic, 1), 0u);
  EXPECT_EQ(yielding(Deformation::elastic, 100), 0u);
}

TEST(Workload, HasTheSizeAskedForAndRepeats) {
  const Workload a = block(8000, Deformation::plastic, 5), b = block(8000, Deformation::plastic, 5);
  EXPECT_EQ(a.state.particles.size(), 8000u);
  EXPECT_EQ(a.state.particles.x[4321], b.state.particles.x[4321]);
  EXPECT_NE(a.state.particles.x[4321],
            block(8000, Deformation::plastic, 6).state.particles.x[4321]);
}

TEST(Probes, AThreadReachesPlausibleRates) {
  // Any processor since 2008 does 1 Gflop/s; none has 1 Tflop/s on one core.
  for (const double rate : {fma_peak_float(1), fma_peak_double(1)}) {
    EXPECT_GT(rate, 1e9);
    EXPECT_LT(rate, 1e12);
  }
  EXPECT_FALSE(instruction_set().empty());
}

TEST(Statistics, QuantilesOfFiveNumbers) {
  const std::vector<double> five = {5, 1, 3, 2, 4};
  EXPECT_EQ(median(five), 3);
  EXPECT_EQ(quantile(five, 0.25), 2);
  EXPECT_DOUBLE_EQ(relative_spread(five), 2.0 / 3);
  EXPECT_EQ(three_digits(0.0123456), 0.0123);
  EXPECT_EQ(percent(0.0316), "3.2 %");
}

}  // namespace
}  // namespace firn::bench
