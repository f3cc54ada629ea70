// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "reference/exp.hpp"
#include "verification/tests/reference/scenes.hpp"

namespace firn::reference {
namespace {

/// |exp(x) − eˣ| in units of the last place of the result; long double is 2^11
/// times finer than what is judged.
double error_in_ulps(double x) {
  const long double exact = std::exp(static_cast<long double>(x));
  int exponent = 0;
  std::frexp(static_cast<double>(exact), &exponent);
  const long double ulp = std::ldexp(1.0L, std::max(exponent - 53, -1074));
  return static_cast<double>(std::abs(exp(x) - exact) / ulp);
}

TEST(Exp, WithinOneUnitInTheLastPlace) {
  test::Random random(1);
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    worst = std::max(worst, error_in_ulps(709 * random()));
    worst = std::max(worst, error_in_ulps(2 * random()));  // hardening of snow
    worst = std::max(worst, error_in_ulps(std::pow(10, 8 * random() - 8)));
  }
  for (double x = -745; x < -700; x += 0.01) worst = std::max(worst, error_in_ulps(x));  // denormal
  RecordProperty("largest_error_in_ulps", std::to_string(worst));
  EXPECT_LE(worst, 1);
}

TEST(Exp, ExactWhereItCanBe) {
  EXPECT_EQ(exp(0), 1);
  EXPECT_EQ(exp(-0.0), 1);
  EXPECT_EQ(exp(1), 2.718281828459045);
  EXPECT_EQ(exp(std::numeric_limits<double>::denorm_min()), 1);
}

TEST(Exp, NeverDecreases) {
  for (const double start : {-700.0, -1.0, -0.35, 0.0, 0.34, 1.0, 30.0, 700.0}) {
    double x = start, last = exp(x);
    for (int i = 0; i < 2000; ++i) {
      x = std::nextafter(x, 1000.0);
      const double next = exp(x);
      ASSERT_GE(next, last) << x;
      last = next;
    }
  }
}

TEST(Exp, Limits) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isfinite(exp(709.78)));
  EXPECT_EQ(exp(709.79), infinity);
  EXPECT_EQ(exp(1e308), infinity);
  EXPECT_EQ(exp(infinity), infinity);
  EXPECT_GT(exp(-745.1), 0);
  EXPECT_EQ(exp(-745.2), 0);
  EXPECT_EQ(exp(-infinity), 0);
  EXPECT_TRUE(std::isnan(exp(std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace firn::reference
