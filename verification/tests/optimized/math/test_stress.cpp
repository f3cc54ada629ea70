// SPDX-License-Identifier: BSD-3-Clause
// Kirchhoff stress and its derivative, the Hessian action, of optimized/math/, on every
// instruction set, in float and double.

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "verification/tests/optimized/math/elastic_cases.hpp"

namespace firn::verification {
namespace {

class StressKernel : public EveryTarget {};

/// τ against the definition. What roundoff can do: E = D + Dᵀ + DDᵀ carries a few eps (‖E‖ + ‖D‖²),
/// the polynomial as much again, and J − 1 likewise; each is multiplied by 2μ or 3λ. Small strains
/// therefore keep their relative accuracy.
template <class T>
void check_stress(const char* name, Matrix (*make)(Random&, double size), double smallest,
                  double bound) {
  SCOPED_TRACE(name);
  const std::size_t n = 3000 * sample_factor;
  Random random(51);
  Packed<T> D(n, 9), mu(n, 1), lambda(n, 1), tau(n, 6);
  for (std::size_t i = 0; i < n; ++i) {
    put(D, i, make(random, std::pow(10.0, random.uniform(smallest, 0))));
    mu(i, 0) = static_cast<T>(random.uniform(1, 2)),
          lambda(i, 0) = static_cast<T>(random.uniform(0, 2));
  }
  const auto& table = kernels::batch_kernels<T>();
  table.kirchhoff_stress(D.data(), mu.data(), lambda.data(), tau.data(), D.packets());
  Spread error;
  for (std::size_t i = 0; i < n; ++i) {
    const Matrix d = matrix(D, i), exact = stress_oracle(d, mu(i, 0), lambda(i, 0));
    const int of[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    Matrix difference;
    for (int k = 0; k < 9; ++k) difference[k] = tau(i, static_cast<std::size_t>(of[k])) - exact[k];
    const long double strain = norm(left_strain(d)) + norm(d) * norm(d);
    const long double unit = roundoff<T> * (2 * mu(i, 0) + 3 * lambda(i, 0)) * strain;
    error.add(unit > 0 ? norm(difference) / unit : norm(difference));
  }
  report(table.target, type_name<T>(), name, error);
  EXPECT_LE(error.largest(), bound);
}

Matrix small_gradient(Random& r, double size) {
  Matrix D;
  for (Real& d : D) d = 0.03 * size * r.uniform(-1, 1);
  return D;
}
Matrix turned_snow(Random& r, double) { return minus_identity(near_the_box(r)); }
Matrix large_strain(Random& r, double size) {
  return minus_identity(with_singular_values(r, 1 + size, r.uniform(0.3, 1), r.uniform(0.3, 1)));
}
Matrix inverted(Random& r, double size) {
  return minus_identity(with_singular_values(r, 1 + size, r.uniform(0.5, 1), -0.25 * r.uniform()));
}
template <class T>
void check_all_stresses() {
  check_stress<T>("stress, gradients of 3e-8 to 3e-2", small_gradient, -6, 8);
  check_stress<T>("stress, snow turned by any rotation", turned_snow, 0, 8);
  check_stress<T>("stress, large strains", large_strain, -1, 8);
  // R is undetermined where σ2 + σ3 = 0; here σ2 + σ3 ≥ 0.25, and the unit of error allows for it.
  check_stress<T>("stress, inverted", inverted, -1, 8);
}

TEST_P(StressKernel, StressAgainstDefinition) {
  check_all_stresses<float>();
  check_all_stresses<double>();
}

/// A reflection: σ2 + σ3 is nearly 0 and R undetermined, but the eigenvalues of τ/2μ are σ² − σ for
/// any choice (λ = 0), so their sum and their sum of squares are known.
template <class T>
void check_reflections() {
  const std::size_t n = 3000 * sample_factor;
  Random random(52);
  Packed<T> D(n, 9), mu(n, 1), lambda(n, 1), tau(n, 6);
  for (std::size_t i = 0; i < n; ++i) {
    Matrix F = near_the_box(random);
    for (Real& a : F) a = -a;
    put(D, i, minus_identity(F));
    mu(i, 0) = T(0.5);
  }
  kernels::batch_kernels<T>().kirchhoff_stress(D.data(), mu.data(), lambda.data(), tau.data(),
                                               D.packets());
  for (std::size_t i = 0; i < n; ++i) {
    const auto s = svd_oracle(plus_identity(matrix(D, i))).sigma;
    Real sum = 0, squares = 0;
    for (Real x : s) sum += x * x - x, squares += (x * x - x) * (x * x - x);
    const Real xx = tau(i, 0), xy = tau(i, 1), xz = tau(i, 2), yy = tau(i, 3), yz = tau(i, 4),
               zz = tau(i, 5);
    // σ² − σ up to 2, its roundoff a dozen eps.
    ASSERT_LE(std::abs(xx + yy + zz - sum), 24 * roundoff<T>) << i;
    ASSERT_LE(std::abs(xx * xx + yy * yy + zz * zz + 2 * (xy * xy + xz * xz + yz * yz) - squares),
              96 * roundoff<T>)
        << i;
  }
}

TEST_P(StressKernel, StressOfReflections) {
  check_reflections<float>();
  check_reflections<double>();
}

/// Undeformed: no stress, exactly. Uniform stretch s: τ = [2μ(s−1)s + λ(s³−1)s³] I.
template <class T>
void check_closed_forms() {
  const std::size_t n = 1000;
  Packed<T> D(n, 9), mu(n, 1), lambda(n, 1), tau(n, 6);
  Random random(61);
  for (std::size_t i = 0; i < n; ++i) {
    const T stretch =
        i ? static_cast<T>(random.sign() * std::pow(10.0, random.uniform(-30, -1.3))) : T(0);
    D(i, 0) = D(i, 4) = D(i, 8) = stretch;
    mu(i, 0) = 3, lambda(i, 0) = 2;
  }
  kernels::batch_kernels<T>().kirchhoff_stress(D.data(), mu.data(), lambda.data(), tau.data(),
                                               D.packets());
  for (std::size_t i = 0; i < n; ++i) {
    const long double e = D(i, 0), s = 1 + e, volume = e * (3 + e * (3 + e));
    const long double exact = 2 * 3 * e * s + 2 * volume * (1 + volume);
    for (std::size_t k : {0u, 3u, 5u})
      ASSERT_LE(std::abs(tau(i, k) - exact), 8 * roundoff<T> * std::abs(exact)) << i;
    for (std::size_t k : {1u, 2u, 4u}) ASSERT_EQ(tau(i, k), 0) << i;
  }
}

TEST_P(StressKernel, StressOfUniformStretch) {
  check_closed_forms<float>();
  check_closed_forms<double>();
}

template <class T>
void check_stress_nan() {
  Packed<T> D(32, 9), mu(32, 1), lambda(32, 1), tau(32, 6);
  for (std::size_t i = 0; i < 32; ++i) mu(i, 0) = lambda(i, 0) = 1;
  D(5, 3) = std::numeric_limits<T>::quiet_NaN();
  D(6, 8) = std::numeric_limits<T>::infinity();
  kernels::batch_kernels<T>().kirchhoff_stress(D.data(), mu.data(), lambda.data(), tau.data(),
                                               D.packets());
  for (std::size_t i = 0; i < 32; ++i)
    for (std::size_t k = 0; k < 6; ++k)
      if (i == 5 || i == 6) {
        ASSERT_FALSE(std::isfinite(tau(i, k))) << i << " " << k;
      } else {
        ASSERT_EQ(tau(i, k), 0) << i;
      }
}

TEST_P(StressKernel, StressOfNotANumber) {
  check_stress_nan<float>();
  check_stress_nan<double>();
}

/// V_p0 A Fᵀ against the definition. Products of L with matrices near a rotation, and K⁻¹ of
/// eigenvalues near ½: a dozen roundings, of half an eps each, of numbers of size (2μ+3λ)‖L‖. The
/// stretch and J − 1 come from D = F − I, whose products are of size ‖D‖², up to 8 where F turns.
/// With large or inverted strains, K⁻¹ multiplies the roundoff of σ by 1/(σ2+σ3)².
template <class T>
void check_hessian(const char* name, Matrix (*make)(Random&, double)) {
  SCOPED_TRACE(name);
  const std::size_t n = 3000 * sample_factor;
  Random random(81);
  Packed<T> D(n, 9), two_mu(n, 1), lambda(n, 1), factors(n, 15), L(n, 9), result(n, 9);
  for (std::size_t i = 0; i < n; ++i) {
    put(D, i, make(random, random.uniform()));
    put(L, i, families_detail::gaussian(random, 1));
    two_mu(i, 0) = static_cast<T>(random.uniform(1, 2));
    lambda(i, 0) = static_cast<T>(random.uniform(0, 2));
  }
  const auto& table = kernels::batch_kernels<T>();
  table.hessian_factors(D.data(), two_mu.data(), lambda.data(), factors.data(), D.packets());
  table.hessian_action(factors.data(), L.data(), result.data(), D.packets());
  Spread error;
  for (std::size_t i = 0; i < n; ++i) {
    const Matrix d = matrix(D, i), F = plus_identity(d), l = matrix(L, i);
    const Matrix exact = hessian_oracle(F, l, Real(two_mu(i, 0)) / 2, lambda(i, 0));
    Matrix difference = matrix(result, i);
    for (int k = 0; k < 9; ++k) difference[k] -= exact[k];
    const auto sigma = svd_oracle(F).sigma;
    const Real size = std::max(Real(1), sigma[0]), sum = std::min(Real(1), sigma[1] + sigma[2]);
    const Real volume = std::pow(size, 6);  // J² ≤ σ1⁶
    const Real unit = two_mu(i, 0) * size * size / (sum * sum) + 3 * lambda(i, 0) * volume;
    const Real products = 1 + norm(d) * norm(d);
    error.add(norm(difference) / (unit * products * norm(l)) / roundoff<T>);
  }
  report(table.target, type_name<T>(), name, error);
  EXPECT_LE(error.largest(), 6);
}

template <class T>
void check_hessians() {
  check_hessian<T>("Hessian, small strains", small_gradient);
  check_hessian<T>("Hessian, snow turned by any rotation", turned_snow);
  check_hessian<T>("Hessian, large strains", large_strain);
  check_hessian<T>("Hessian, inverted", inverted);
}

TEST_P(StressKernel, HessianAction) {
  check_hessians<float>();
  check_hessians<double>();
}

/// Where R is not differentiable the action stays finite; a zero F_E gives zero shear.
template <class T>
void check_hessian_of_singular() {
  Packed<T> D(64, 9), two_mu(64, 1), lambda(64, 1), factors(64, 15), L(64, 9), result(64, 9);
  for (std::size_t i = 0; i < 64; ++i) {
    two_mu(i, 0) = lambda(i, 0) = 1;
    L(i, i % 9) = 1, L(i, (i + 4) % 9) = 2;
    D(i, 0) = i % 4 == 0 ? -1 : 0, D(i, 4) = i % 4 < 2 ? -1 : -2, D(i, 8) = i % 4 == 3 ? 0 : -1;
  }
  const auto& table = kernels::batch_kernels<T>();
  table.hessian_factors(D.data(), two_mu.data(), lambda.data(), factors.data(), D.packets());
  table.hessian_action(factors.data(), L.data(), result.data(), D.packets());
  for (std::size_t i = 0; i < 64; ++i)
    for (std::size_t k = 0; k < 9; ++k) {
      ASSERT_TRUE(std::isfinite(result(i, k))) << i;
      if (i % 4 == 0) {  // F_E = 0
        ASSERT_EQ(result(i, k), 0) << i;
      }
    }
}

TEST_P(StressKernel, HessianActionOfSingularMatrices) {
  check_hessian_of_singular<float>();
  check_hessian_of_singular<double>();
}

FIRN_ON_EVERY_TARGET(StressKernel);

}  // namespace
}  // namespace firn::verification
