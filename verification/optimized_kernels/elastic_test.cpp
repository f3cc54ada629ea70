// Elastic box, polar rotation, stress and exponential of optimized/kernels/, on every instruction
// set, in float and double.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <limits>

#include "verification/optimized_kernels/kernel_fixture.hpp"
#include "verification/oracles/elastic_oracle.hpp"
#include "verification/oracles/svd_families.hpp"

namespace firn::verification {
namespace {

constexpr double theta_c = 2.5e-2, theta_s = 7.5e-3;  // the paper's snow

template <class T>
constexpr long double eps = std::numeric_limits<T>::epsilon();

void report(const char* target, const char* type, const char* what, const Spread& spread) {
  if (std::getenv("FIRN_PRINT_ERRORS"))
    std::printf("%-7s %-6s %-44s largest %6.2f  99.9 %% %6.2f\n", target, type, what,
                spread.largest(), spread.quantile(0.999));
}

template <class T>
const char* type_name() {
  return sizeof(T) == 4 ? "float" : "double";
}

/// F − I
Matrix minus_identity(Matrix F) {
  F[0] -= 1, F[4] -= 1, F[8] -= 1;
  return F;
}

/// F with singular values inside or near the elastic box, turned by any rotation.
Matrix near_the_box(Random& r) {
  const double a = 1 - 1.2 * theta_c, b = 1 + 1.5 * theta_s;
  return with_singular_values(r, r.uniform(a, b), r.uniform(a, b), r.uniform(a, b));
}

/// F whose largest or smallest singular value is a few eps from its limit.
template <class T>
Matrix at_the_limit(Random& r) {
  const long double k = r.uniform(-40, 40) * eps<T>;
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
    const long double beyond = std::max(below, above) / eps<T>;
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
    skew.add(std::hypot(S[1] - S[3], std::hypot(S[2] - S[6], S[5] - S[7])) / 2 / eps<T>);
    orthogonality.add(orthogonality_error(r) / eps<T>);
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
      skew.add(std::hypot(S[1] - S[3], std::hypot(S[2] - S[6], S[5] - S[7])) / 2 / size / eps<T>);
      orthogonality.add(orthogonality_error(r) / eps<T>);
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
    const long double unit = eps<T> * (2 * mu(i, 0) + 3 * lambda(i, 0)) * strain;
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
  // R is undetermined where σ2 + σ3 = 0; here σ2 + σ3 ≥ 0.25, which multiplies the roundoff.
  check_stress<T>("stress, inverted", inverted, -1, 60);
}

TEST_P(ElasticKernel, StressAgainstDefinition) {
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
    ASSERT_LE(std::abs(xx + yy + zz - sum), 24 * eps<T>) << i;
    ASSERT_LE(std::abs(xx * xx + yy * yy + zz * zz + 2 * (xy * xy + xz * xz + yz * yz) - squares),
              96 * eps<T>)
        << i;
  }
}

TEST_P(ElasticKernel, StressOfReflections) {
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
      ASSERT_LE(std::abs(tau(i, k) - exact), 8 * eps<T> * std::abs(exact)) << i;
    for (std::size_t k : {1u, 2u, 4u}) ASSERT_EQ(tau(i, k), 0) << i;
  }
}

TEST_P(ElasticKernel, StressOfUniformStretch) {
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

TEST_P(ElasticKernel, StressOfNotANumber) {
  check_stress_nan<float>();
  check_stress_nan<double>();
}

/// V_p0 A Fᵀ against the definition. Products of L with matrices near a rotation, and K⁻¹ of
/// eigenvalues near ½: a dozen roundings of numbers of size (2μ+3λ)‖L‖. With large or inverted
/// strains, K⁻¹ multiplies the roundoff of σ by 1/(σ2+σ3)².
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
    const Matrix F = plus_identity(matrix(D, i)), l = matrix(L, i);
    const Matrix exact = hessian_oracle(F, l, Real(two_mu(i, 0)) / 2, lambda(i, 0));
    Matrix difference = matrix(result, i);
    for (int k = 0; k < 9; ++k) difference[k] -= exact[k];
    const auto sigma = svd_oracle(F).sigma;
    const Real size = std::max(Real(1), sigma[0]), sum = std::min(Real(1), sigma[1] + sigma[2]);
    const Real volume = std::pow(size, 6);  // J² ≤ σ1⁶
    const Real unit = two_mu(i, 0) * size * size / (sum * sum) + 3 * lambda(i, 0) * volume;
    error.add(norm(difference) / (unit * norm(l)) / eps<T>);
  }
  report(table.target, type_name<T>(), name, error);
  EXPECT_LE(error.largest(), 8);
}

template <class T>
void check_hessians() {
  check_hessian<T>("Hessian, small strains", small_gradient);
  check_hessian<T>("Hessian, snow turned by any rotation", turned_snow);
  check_hessian<T>("Hessian, large strains", large_strain);
  check_hessian<T>("Hessian, inverted", inverted);
}

TEST_P(ElasticKernel, HessianAction) {
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

TEST_P(ElasticKernel, HessianActionOfSingularMatrices) {
  check_hessian_of_singular<float>();
  check_hessian_of_singular<double>();
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
    const long double ulp = std::max(std::ldexp(eps<T>, std::ilogb(exact)),
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
