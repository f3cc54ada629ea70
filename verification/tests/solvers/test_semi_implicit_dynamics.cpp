// SPDX-License-Identifier: BSD-3-Clause
// The order in Δt of the semi-implicit update. Closed forms, energy and plane waves are asked of
// every solver by verification/suite.

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "verification/tests/solvers/semi_implicit_systems.hpp"

namespace firn::test {
namespace {

class Dynamics : public testing::TestWithParam<Subject> {
 protected:
  bool in_float() const { return GetParam().precision == Precision::float32; }
};

/// At a fixed time the two integrators differ by O(Δt).
TEST_P(Dynamics, FixedTimeDiffersFromExplicitByFirstOrder) {
  if (in_float()) GTEST_SKIP() << "differences of a difference: below the roundoff of float";
  Scene scene = implicit_scene();
  scene.flip = 1;  // PIC damps once per step: with α < 1 the limit Δt → 0 is another problem
  scene.materials[0].critical_compression = scene.materials[0].critical_stretch =
      std::numeric_limits<double>::infinity();
  State initial = fixtures::lattice_block(scene, {3, 3, 3});
  const double h = scene.grid.spacing;
  for (std::size_t p = 0; p < initial.particles.size(); ++p)
    initial.particles.v[p] = 0.1 * Vec3(std::sin(9 * initial.particles.x[p][1] / h), 0,
                                        std::cos(7 * initial.particles.x[p][0] / h));
  const double end = 4e-4;
  const auto difference = [&](int steps) {
    Particles results[2];
    for (const bool implicit : {false, true}) {
      Scene one = scene;
      if (!implicit) one.integrator.type = IntegratorType::explicit_euler;
      const auto solver = GetParam().create();
      solver->load(one, initial);
      for (int n = 0; n < steps; ++n) solver->step(end / steps);
      State state;
      solver->store(state);
      results[implicit ? 1 : 0] = state.particles;
    }
    double sum = 0;
    for (std::size_t p = 0; p < results[0].size(); ++p)
      sum += (results[0].v[p] - results[1].v[p]).squaredNorm();
    return std::sqrt(sum);
  };
  const double coarse = difference(8), middle = difference(16), fine = difference(32);
  // Order 1, with a next term that halves: Richardson leaves half of its deviation from 2.
  EXPECT_NEAR(coarse / middle, 2, 0.3);
  EXPECT_NEAR(middle / fine, 2, 0.15);
}

INSTANTIATE_TEST_SUITE_P(Every, Dynamics, testing::ValuesIn(subjects()),
                         [](const auto& info) { return text(info.param); });

}  // namespace
}  // namespace firn::test
