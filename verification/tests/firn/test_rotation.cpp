// SPDX-License-Identifier: BSD-3-Clause
// Rotations against the C library's long double sine and cosine, and the matrix
// against Eigen's.

#include <cmath>
#include <gtest/gtest.h>

#include "firn/rotation.hpp"
#include "verification/support/eps.hpp"
#include "verification/support/points.hpp"

namespace firn {
namespace {

using fixtures::random_direction;

TEST(Rotation, SineAndCosineAgreeWithExtendedPrecision) {
  for (const double scale : {1.0, 10.0, 1e3, 1e6, 1e9})
    for (int p = 0; p < 2000; ++p) {
      const double angle = scale * (2 * uniform(1, {p}) - 1);
      const auto [s, c] = sine_cosine(angle);
      // Polynomials and their last sums: 2 roundings of numbers up to 1; the
      // reduced angle: eps/2 of it. Above 2²⁰ quarters their product with π/2 is
      // rounded, too, by eps/2·|θ|, which is what θ itself is uncertain by.
      const double bound = 2 * eps + (std::abs(angle) > 1.6e6 ? eps * std::abs(angle) : 0);
      EXPECT_NEAR(s, double(std::sin((long double)angle)), bound) << angle;
      EXPECT_NEAR(c, double(std::cos((long double)angle)), bound) << angle;
    }
}

TEST(Rotation, SineIsExactWhereItMustBe) {
  EXPECT_EQ(sine_cosine(0).sine, 0);
  EXPECT_EQ(sine_cosine(0).cosine, 1);
  EXPECT_EQ(sine_cosine(1e-9).sine, 1e-9);
  EXPECT_EQ(sine_cosine(-1e-9).sine, -1e-9);
}

TEST(Rotation, MatrixAgreesWithEigen) {
  for (int p = 0; p < 500; ++p) {
    const Vec3 axis = random_direction(2, p);
    const double angle = 20 * (2 * uniform(3, {p}) - 1);
    const Mat3 R = rotation_about(axis, angle);
    const Mat3 expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    EXPECT_LT((R - expected).cwiseAbs().maxCoeff(), 8 * eps);  // some 4 roundings a side
    EXPECT_LT((R.transpose() * R - Mat3::Identity()).cwiseAbs().maxCoeff(), 16 * eps);
  }
}

TEST(Rotation, QuarterTurnAboutZ) {
  const Mat3 R = rotation_about(Vec3::UnitZ(), 1.5707963267948966);
  EXPECT_LT((R * Vec3::UnitX() - Vec3::UnitY()).norm(), eps);
}

}  // namespace
}  // namespace firn
