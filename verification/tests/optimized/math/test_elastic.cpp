// SPDX-License-Identifier: BSD-3-Clause
// Elastic box, polar rotation and exponential of optimized/math/, on every instruction set, in
// float and double.

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "verification/tests/optimized/math/elastic_cases.hpp"

namespace firn::verification {
namespace {

/// F whose largest or smallest singular value is a few eps from its limit.
template <class T>
Matrix at_the_limit(Random& r) {
  const long double k = r.uniform(-40, 40) * roundoff<T>;
  const long double other = r.uniform(1 - theta_c, 1 + theta_s);
  return r.below(2)
             ? with_singular_values(r, 1 + theta_s + k, other, r.below(2) ? other : 1 + theta_s + k)
             : with_singular_values(r, 1 - theta_c + k, other,
                                    r.below(2) ? other : 1 - theta_c + k);
}

class ElasticKernel : public EveryTarget {};

/// "Inside" is never claimed more than 4 eps beyond a limit, whatever the rotation; and never
/// refused to an F that is 24 eps inside (margin 4 eps in σ, and the roundoff of F − I near a half
/// turn).
template <class T>
void check_box() {
  const std::size_t n = 20000 * sample_factor;
  Random random(21);
  Packed<T> D(n, 9), inside(n, 1);
  for (std::size_t i = 0; i < n; ++i) {
    const int kind = static_cast<int>(i % 4);
    Matrix F = kind == 0   ? near_the_box(random)
               : kind == 1 ? families_detail::near_identity(random)
                           : at_the_limit<T>(random);
    if (i % 64 == 3)  // a reflection: FᵀF is inside, F is not
      for (Real& a : F) a = -a;
    put(D, i, minus_identity(F));
  }
  const auto box = kernels::ElasticBox<T>::from(theta_c, theta_s);
  kernels::batch_kernels<T>().inside_elastic_box(D.data(), box, inside.data(), D.packets());
  std::size_t claimed = 0, refused_wrongly = 0, refused_clearly = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Svd exact = svd_oracle(plus_identity(matrix(D, i)));
    const long double below = (1 - theta_c) - exact.sigma[2],
                      above = exact.sigma[0] - (1 + theta_s);
    const long double beyond = std::max(below, above) / roundoff<T>;
    if (inside(i, 0) == 1) {
      ++claimed;
      ASSERT_LE(beyond, 4) << i;
    } else {
      refused_wrongly += beyond < 0;
      refused_clearly += beyond > 4;
      ASSERT_GE(beyond, -24) << i;
    }
  }
  // The sample has plenty of each kind, so each assertion above was exercised.
  EXPECT_GT(claimed, n / 5);
  EXPECT_GT(refused_wrongly, n / 1000);
  EXPECT_GT(refused_clearly, n / 5);
}

TEST_P(ElasticKernel, InsideIsNeverClaimedFalsely) {
  check_box<float>();
  check_box<double>();
}

template <class T>
void check_box_not_a_number() {
  const std::size_t n = 9 * 3;
  Packed<T> D(n, 9), inside(n, 1);
  for (std::size_t i = 0; i < n; ++i)
    D(i, i / 3) = i % 3 == 0   ? std::numeric_limits<T>::quiet_NaN()
                  : i % 3 == 1 ? std::numeric_limits<T>::infinity()
                               : std::numeric_limits<T>::max();
  for (double theta : {theta_s, std::numeric_limits<double>::infinity()}) {
    const auto box = kernels::ElasticBox<T>::from(theta == theta_s ? theta_c : theta, theta);
    kernels::batch_kernels<T>().inside_elastic_box(D.data(), box, inside.data(), D.packets());
    for (std::size_t i = 0; i < n; ++i)
      if (i % 3 != 2 || theta == theta_s) {
        ASSERT_EQ(inside(i, 0), 0) << i;
      }
  }
}

TEST_P(ElasticKernel, NotANumberIsNotInside) {
  check_box_not_a_number<float>();
  check_box_not_a_number<double>();
}

/// ‖skew(RᵀF)‖ and ‖RᵀR − I‖ of Newton's iteration for F near a rotation: 2 and 5 eps.
template <class T>
void check_newton_polar() {
  const std::size_t n = 10000 * sample_factor;
  Random random(31);
  Packed<T> F(n, 9), R(n, 9);
  for (std::size_t i = 0; i < n; ++i)
    put(F, i,
        i % 2 ? with_singular_values(random, random.uniform(0.95, 1.05), random.uniform(0.95, 1.05),
                                     random.uniform(0.95, 1.05))
              : near_the_box(random));
  const auto& table = kernels::batch_kernels<T>();
  table.polar_near_rotation(F.data(), R.data(), F.packets());
  Spread skew, orthogonality, distance;
  for (std::size_t i = 0; i < n; ++i) {
    const Matrix r = matrix(R, i), S = multiply(transpose(r), matrix(F, i));
    skew.add(std::hypot(S[1] - S[3], std::hypot(S[2] - S[6], S[5] - S[7])) / 2 / roundoff<T>);
    orthogonality.add(orthogonality_error(r) / roundoff<T>);
    ASSERT_GT(det(r), 0);
  }
  report(table.target, type_name<T>(), "Newton polar, skew", skew);
  report(table.target, type_name<T>(), "Newton polar, orthogonality", orthogonality);
  EXPECT_LE(skew.largest(), 2);
  EXPECT_LE(orthogonality.largest(), 5);
}

TEST_P(ElasticKernel, NewtonPolarNearRotations) {
  check_newton_polar<float>();
  check_newton_polar<double>();
}

/// The polar factor of any F: 4 and 12 eps, relative to ‖F‖; det R = +1 also for inverted F.
template <class T>
void check_polar() {
  const std::size_t n = 1000 * sample_factor;
  std::uint64_t seed = 41;
  const auto& table = kernels::batch_kernels<T>();
  Spread skew, orthogonality;
  for (const Family& family : svd_families()) {
    SCOPED_TRACE(family.name);
    Random random(seed++);
    Packed<T> F(n, 9), R(n, 9);
    for (std::size_t i = 0; i < n; ++i) put(F, i, family.make(random, sizeof(T) == 4));
    table.polar(F.data(), R.data(), F.packets());
    for (std::size_t i = 0; i < n; ++i) {
      const Matrix r = matrix(R, i), f = matrix(F, i), S = multiply(transpose(r), f);
      const long double size =
          std::max(norm(f), static_cast<long double>(std::numeric_limits<T>::min()));
      skew.add(std::hypot(S[1] - S[3], std::hypot(S[2] - S[6], S[5] - S[7])) / 2 / size /
               roundoff<T>);
      orthogonality.add(orthogonality_error(r) / roundoff<T>);
      ASSERT_GT(det(r), 0) << i;
    }
  }
  report(table.target, type_name<T>(), "polar, skew", skew);
  report(table.target, type_name<T>(), "polar, orthogonality", orthogonality);
  EXPECT_LE(skew.largest(), 4);
  EXPECT_LE(orthogonality.largest(), 12);
}

TEST_P(ElasticKernel, PolarOfEveryFamily) {
  check_polar<float>();
  check_polar<double>();
}

/// e^x within 1.05 ulp over the whole range, infinity and zero where they belong, denormal results.
template <class T>
void check_exp() {
  using limits = std::numeric_limits<T>;
  const std::size_t n = 100000 * sample_factor;
  const double top = std::log(static_cast<double>(limits::max()));
  const double bottom = sizeof(T) == 4 ? -104 : -746;
  Random random(71);
  Packed<T> x(n, 1), y(n, 1);
  for (std::size_t i = 0; i < n; ++i)
    x(i, 0) = static_cast<T>(i % 2 ? random.uniform(bottom, top) : random.uniform(-2, 2));
  const T special[] = {0,
                       -T(0),
                       1,
                       limits::infinity(),
                       -limits::infinity(),
                       limits::max(),
                       limits::lowest(),
                       static_cast<T>(top * 1.0001),
                       limits::denorm_min(),
                       limits::quiet_NaN(),
                       static_cast<T>(bottom * 1.01)};
  for (std::size_t k = 0; k < std::size(special); ++k) x(k, 0) = special[k];
  const auto& table = kernels::batch_kernels<T>();
  table.exp(x.data(), y.data(), x.packets());
  const T expected[] = {
      1, 1, y(2, 0), limits::infinity(), 0, limits::infinity(), 0, limits::infinity(), 1, 0, 0};
  for (std::size_t k = 0; k < std::size(special); ++k) {
    if (std::isnan(special[k])) {
      EXPECT_TRUE(std::isnan(y(k, 0)));
    } else {
      EXPECT_EQ(y(k, 0), expected[k]) << special[k];
    }
  }
  Spread ulps;
  for (std::size_t i = std::size(special); i < n; ++i) {
    const long double exact = std::exp(static_cast<long double>(x(i, 0)));
    const long double ulp = std::max(std::ldexp(roundoff<T>, std::ilogb(exact)),
                                     static_cast<long double>(limits::denorm_min()));
    ulps.add(std::abs(y(i, 0) - exact) / ulp);
  }
  report(table.target, type_name<T>(), "exp, in ulp", ulps);
  // In ulps just below a power of two: half of one for the last sum, a quarter each for r and for
  // r + r² q, a twentieth for the polynomial.
  EXPECT_LE(ulps.largest(), 1.05);
}

TEST_P(ElasticKernel, Exponential) {
  check_exp<float>();
  check_exp<double>();
}

FIRN_ON_EVERY_TARGET(ElasticKernel);

}  // namespace
}  // namespace firn::verification
