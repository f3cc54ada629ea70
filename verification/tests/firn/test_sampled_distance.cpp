// SPDX-License-Identifier: BSD-3-Clause
// Distances on a grid: the interpolant against fields that it represents
// exactly, its continuation beyond the box, and its bounds.

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <stdexcept>

#include "firn/sampled_distance.hpp"
#include "verification/support/points.hpp"

namespace firn {
namespace {

using fixtures::random_direction;
using fixtures::random_point;

SampledDistance sample(const std::function<double(const Vec3&)>& field, const Vec3& origin,
                       double spacing, const std::array<int, 3>& size) {
  std::vector<float> phi;
  for (int i = 0; i < size[0]; ++i)
    for (int j = 0; j < size[1]; ++j)
      for (int k = 0; k < size[2]; ++k)
        phi.push_back(static_cast<float>(field(origin + spacing * Vec3(i, j, k))));
  return {origin, spacing, size, phi};
}

double unit_sphere(const Vec3& x) { return x.norm() - 1; }

SampledDistance sampled_unit_sphere(double spacing) {
  const int n = static_cast<int>(std::lround(3 / spacing)) + 1;
  return sample(unit_sphere, Vec3::Constant(-1.5), spacing, {n, n, n});
}

TEST(SampledDistance, ReproducesTrilinearFieldsExactly) {
  // Coefficients of few bits, so that the float samples are exact.
  const auto field = [](const Vec3& x) {
    return 20 + x[0] - 2 * x[1] + 0.5 * x[2] + x[0] * x[1] - x[1] * x[2] + 0.25 * x[0] * x[2] +
           0.5 * x[0] * x[1] * x[2];
  };
  const auto gradient = [](const Vec3& x) {
    return Vec3(1 + x[1] + 0.25 * x[2] + 0.5 * x[1] * x[2], -2 + x[0] - x[2] + 0.5 * x[0] * x[2],
                0.5 - x[1] + 0.25 * x[0] + 0.5 * x[0] * x[1]);
  };
  const SampledDistance d = sample(field, Vec3(-1, -0.5, -0.25), 0.25, {7, 6, 5});
  for (int p = 0; p < 300; ++p) {
    const Vec3 u = random_point(1, p, Vec3::Constant(0.5), 0.5);
    const Vec3 x = d.box().min + u.cwiseProduct(d.box().max - d.box().min);
    EXPECT_NEAR(d.distance(x), field(x), 1e-13);             // values of 25, some 20 roundings
    EXPECT_LT((d.gradient(x) - gradient(x)).norm(), 1e-12);  // differences over 0.25
  }
}

TEST(SampledDistance, SphereIsSecondOrderAccurate) {
  double error[2] = {};
  for (int level = 0; level < 2; ++level) {
    const SampledDistance d = sampled_unit_sphere(level == 0 ? 0.1 : 0.05);
    for (int p = 0; p < 2000; ++p) {
      const Vec3 x = (0.5 + uniform(2, {p})) * random_direction(3, p);
      if (x.cwiseAbs().maxCoeff() > 1.5) continue;
      error[level] = std::max(error[level], std::abs(d.distance(x) - unit_sphere(x)));
    }
  }
  // Trilinear interpolation errs by at most Σ_axis s²/8·|φ_aa| ≤ s²/8·ΔΦ = s²/4r, r ≥ 0.4 within a
  // cell.
  EXPECT_LT(error[0], 0.01 / 4 / 0.4);
  EXPECT_LT(error[1], 0.0025 / 4 / 0.4);
  EXPECT_GT(error[0] / error[1], 3);  // 4 at second order
}

TEST(SampledDistance, GradientIsThatOfTheDistanceInsideAndBeyondTheBox) {
  const SampledDistance d = sampled_unit_sphere(0.125);
  const double step = 1e-6;
  int beyond = 0;
  for (int p = 0; p < 1000; ++p) {
    const Vec3 x = random_point(4, p, Vec3::Zero(), 4);
    Vec3 place = (x - d.box().min) / d.spacing();
    place -= place.array().round().matrix();
    if ((place.array().abs() < 1e-4).any()) continue;  // a kink within the difference
    Vec3 difference;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 dx = step * Vec3::Unit(axis);
      difference[axis] = (d.distance(x + dx) - d.distance(x - dx)) / (2 * step);
    }
    // Piecewise trilinear, or with second derivatives below 2/φ: truncation is
    // step² / φ² ~ 1e-11, rounding eps·4/step = 1e-9.
    EXPECT_LT((d.gradient(x) - difference).norm(), 1e-8) << x.transpose();
    beyond += x.cwiseAbs().maxCoeff() > 1.5;
  }
  EXPECT_GT(beyond, 500);
}

TEST(SampledDistance, BeyondTheBoxItIsContinuousAndNeverTooLarge) {
  const SampledDistance d = sampled_unit_sphere(0.1);
  const double interpolation = 0.01 / 4 / 1.4;  // s²/4r near the box's faces, as above
  for (int p = 0; p < 1000; ++p) {
    const Vec3 x = 1.5 * random_direction(5, p) / random_direction(5, p).cwiseAbs().maxCoeff();
    EXPECT_NEAR(d.distance(x * (1 + 1e-9)), d.distance(x * (1 - 1e-9)), 1e-7);
    const Vec3 outside = random_point(6, p, Vec3::Zero(), 20);
    if (outside.cwiseAbs().maxCoeff() < 1.5) continue;
    EXPECT_LE(d.distance(outside), unit_sphere(outside) + interpolation);
    // φ ≤ ‖x − q‖ + φ(q), and φ(q) ≤ √3·1.5 − 1 at the box's corners.
    EXPECT_GE(d.distance(outside), unit_sphere(outside) - 1.6);
  }
  // Straight out from a face, the continuation is far off only by the face's own distance.
  EXPECT_NEAR(d.distance(Vec3(1000, 0, 0)), std::sqrt(998.5 * 998.5 + 0.25), 1e-3);
}

TEST(SampledDistance, LipschitzBoundHoldsAndIsTight) {
  const SampledDistance d = sampled_unit_sphere(0.1);
  const double L = d.lipschitz_bound();
  // Beside the centre of a sphere the interpolant rises at slope 1 along all
  // three axes at once: the bound √3 is reached there.
  EXPECT_NEAR(L, std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(d.gradient(Vec3::Constant(1e-9)).norm(), L, 1e-6);
  for (int p = 0; p < 2000; ++p) {
    const Vec3 x = random_point(7, p, Vec3::Zero(), 2),
               y = x + random_point(8, p, Vec3::Zero(), 0.2);
    EXPECT_LE(std::abs(d.distance(x) - d.distance(y)), L * (x - y).norm() + 1e-14);
  }
  // A field three times as steep is found out.
  const auto steep = [](const Vec3& x) { return 3 * unit_sphere(x); };
  EXPECT_NEAR(sample(steep, Vec3::Constant(-1.5), 0.1, {31, 31, 31}).lipschitz_bound(), 3 * L,
              1e-5);
}

TEST(SampledDistance, BoundsAreThoseOfTheInterpolantsSolid) {
  const SampledDistance d =
      sample([](const Vec3& x) { return (x - Vec3(0.1, 0, -0.1)).norm() - 1; },
             Vec3::Constant(-1.5), 0.125, {25, 25, 25});
  const Bounds b = d.solid_bounds();
  Bounds seen{Vec3::Constant(9), Vec3::Constant(-9)};
  for (int i = 0; i <= 120; ++i)
    for (int j = 0; j <= 120; ++j)
      for (int k = 0; k <= 120; ++k) {
        const Vec3 x = Vec3::Constant(-1.5) + 0.025 * Vec3(i, j, k);
        if (d.distance(x) > 0) continue;
        seen.min = seen.min.cwiseMin(x);
        seen.max = seen.max.cwiseMax(x);
      }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LE(b.min[axis], seen.min[axis] + 1e-12);
    EXPECT_GE(b.max[axis], seen.max[axis] - 1e-12);
    EXPECT_GE(b.min[axis], seen.min[axis] - 0.025);  // the search's own step
    EXPECT_LE(b.max[axis], seen.max[axis] + 0.025);
  }
}

TEST(SampledDistance, ShapeOfASampledSphereBehavesAsASphere) {
  const Shape shape = SampledShape{std::make_shared<SampledDistance>(sampled_unit_sphere(0.0625))};
  EXPECT_LT(center(shape).norm(), 1e-6);
  EXPECT_LT((bounds(shape)->max - Vec3::Ones()).norm(), 0.0625 * 0.0625);
  for (int p = 0; p < 500; ++p) {
    const Vec3 x = random_point(9, p, Vec3::Zero(), 1.4);
    if (x.norm() < 0.3) continue;
    // The gradient errs by s·|φ''| ≤ 0.0625/0.3.
    EXPECT_LT((outward_normal(shape, x) - x.normalized()).norm(), 0.0625 / x.norm());
    EXPECT_EQ(contains(shape, x), signed_distance(shape, x) < 0);
  }
  EXPECT_NEAR(outward_normal(shape, Vec3::Zero()).norm(), 1, 1e-15);
}

TEST(SampledDistance, AFieldWithoutSolidHasEmptyBounds) {
  const SampledDistance d = sample([](const Vec3&) { return 1.0; }, Vec3::Zero(), 1, {2, 3, 4});
  EXPECT_GT(d.solid_bounds().min[0], d.solid_bounds().max[0]);
  EXPECT_EQ(d.lipschitz_bound(), 1);
}

TEST(SampledDistance, RefusesWhatItCannotContinue) {
  const std::vector<float> ones(8, 1.0f);
  EXPECT_NO_THROW(SampledDistance(Vec3::Zero(), 1, {2, 2, 2}, ones));
  EXPECT_THROW(SampledDistance(Vec3::Zero(), 0, {2, 2, 2}, ones), std::invalid_argument);
  EXPECT_THROW(SampledDistance(Vec3::Zero(), 1, {1, 4, 2}, ones), std::invalid_argument);
  EXPECT_THROW(SampledDistance(Vec3::Zero(), 1, {2, 2, 3}, ones), std::invalid_argument);
  for (int corner = 0; corner < 8; ++corner) {
    std::vector<float> phi = ones;
    phi[corner] = 0;  // every point of a 2×2×2 grid is on the border
    EXPECT_THROW(SampledDistance(Vec3::Zero(), 1, {2, 2, 2}, phi), std::invalid_argument);
    phi[corner] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(SampledDistance(Vec3::Zero(), 1, {2, 2, 2}, phi), std::invalid_argument);
  }
}

}  // namespace
}  // namespace firn
