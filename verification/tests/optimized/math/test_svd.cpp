// SPDX-License-Identifier: BSD-3-Clause
// The decomposition of optimized/math/svd-inl.h: every family, every instruction set, float and
// double, against a one-sided Jacobi method in long double.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <memory>

#include "verification/oracles/svd_families.hpp"
#include "verification/oracles/svd_oracle.hpp"
#include "verification/tests/optimized/math/kernel_fixture.hpp"

namespace firn::verification {
namespace {

constexpr std::size_t matrices_per_family = 2000 * sample_factor;

/// A family's matrices, rounded to T, with their exact decompositions: made once, used by every
/// instruction set.
template <class T>
struct Sample {
  Packed<T> A;
  std::vector<Svd> exact;
};

template <class T>
Sample<T> make_sample(const Family& family, std::size_t count, std::uint64_t seed) {
  Sample<T> s{Packed<T>(count, 9), {}};
  Random random(seed);
  for (std::size_t i = 0; i < count; ++i) {
    put(s.A, i, family.make(random, sizeof(T) == 4));
    s.exact.push_back(svd_oracle(matrix(s.A, i)));
  }
  return s;
}

template <class T>
struct Decomposition {
  Packed<T> U, sigma, V;
  explicit Decomposition(std::size_t n) : U(n, 9), sigma(n, 3), V(n, 9) {}
  Svd at(std::size_t i) const {
    Svd r;
    r.U = matrix(U, i), r.V = matrix(V, i);
    for (int k = 0; k < 3; ++k) r.sigma[k] = sigma(i, k);
    return r;
  }
};

template <class T>
Decomposition<T> decompose(const Packed<T>& A, void (*svd)(const T*, T*, T*, T*, std::size_t)) {
  Decomposition<T> r(A.size());
  svd(A.data(), r.U.data(), r.sigma.data(), r.V.data(), A.packets());
  return r;
}

class SvdKernel : public EveryTarget {};

/// The bounds of every family. A dozen roundings of unit numbers stand behind each entry; random
/// signs leave the 99.9th percentile at half of the largest.
template <class T>
void check_svd_family(const Family& family, std::uint64_t seed) {
  SCOPED_TRACE(family.name);
  const Sample<T> sample = make_sample<T>(family, matrices_per_family, seed);
  const auto computed = decompose(sample.A, kernels::batch_kernels<T>().svd);
  Spread backward, orthogonality, sigma;
  const long double grain = std::numeric_limits<T>::denorm_min();
  for (std::size_t i = 0; i < sample.A.size(); ++i) {
    const SvdErrors e =
        svd_errors(matrix(sample.A, i), computed.at(i), sample.exact[i], roundoff<T>, grain);
    ASSERT_TRUE(e.finite) << "matrix " << i;
    ASSERT_TRUE(e.rotations) << "matrix " << i;
    ASSERT_TRUE(e.ordered) << "matrix " << i;
    ASSERT_TRUE(e.sign) << "matrix " << i;
    backward.add(e.backward);
    orthogonality.add(std::max(e.orthogonality_U, e.orthogonality_V));
    sigma.add(e.sigma);
  }
  if (std::getenv("FIRN_PRINT_ERRORS"))
    std::printf(
        "%-7s %-6s %-40s backward %5.2f %5.2f  orthogonality %5.2f %5.2f  sigma %5.2f %5.2f\n",
        kernels::batch_kernels<T>().target, sizeof(T) == 4 ? "float" : "double", family.name,
        backward.largest(), backward.quantile(0.999), orthogonality.largest(),
        orthogonality.quantile(0.999), sigma.largest(), sigma.quantile(0.999));
  EXPECT_LE(backward.largest(), 10);
  EXPECT_LE(backward.quantile(0.999), 5);
  EXPECT_LE(orthogonality.largest(), 12);
  EXPECT_LE(orthogonality.quantile(0.999), 7);
  EXPECT_LE(sigma.largest(), 6);
  EXPECT_LE(sigma.quantile(0.999), 3);
}

TEST_P(SvdKernel, FamiliesInFloat) {
  std::uint64_t seed = 1;
  for (const Family& f : svd_families()) check_svd_family<float>(f, seed++);
}

TEST_P(SvdKernel, FamiliesInDouble) {
  std::uint64_t seed = 1001;
  for (const Family& f : svd_families()) check_svd_family<double>(f, seed++);
}

/// Zero, identity and signed diagonal matrices: Σ carries the entries' very bits.
template <class T>
void check_exact() {
  const std::size_t n = 4096;
  Random random(7);
  Packed<T> A(n, 9);
  for (std::size_t i = 2; i < n; ++i)
    for (int k = 0; k < 3; ++k)
      A(i, static_cast<std::size_t>(4 * k)) = static_cast<T>(
          random.sign() * (i % 2 ? random.uniform(0.5, 2) : static_cast<double>(random.below(3))));
  for (int k = 0; k < 3; ++k) A(1, static_cast<std::size_t>(4 * k)) = 1;
  const auto r = decompose(A, kernels::batch_kernels<T>().svd);
  for (std::size_t i = 0; i < n; ++i) {
    std::array<T, 3> expected = {std::abs(A(i, 0)), std::abs(A(i, 4)), std::abs(A(i, 8))};
    std::sort(expected.rbegin(), expected.rend());
    if (A(i, 0) * A(i, 4) * A(i, 8) < 0) expected[2] = -expected[2];
    for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(r.sigma(i, k), expected[k]) << i << " " << k;
  }
}

TEST_P(SvdKernel, DiagonalMatricesExactly) {
  check_exact<float>();
  check_exact<double>();
}

/// A mixture of all families and of lanes that are not numbers.
template <class T>
Packed<T> mixture(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  Packed<T> A(count, 9);
  const auto& families = svd_families();
  for (std::size_t i = 0; i < count; ++i) {
    const auto f = static_cast<std::size_t>(random.below(static_cast<int>(families.size())));
    put(A, i, families[f].make(random, sizeof(T) == 4));
    if (random.below(20) == 0)
      A(i, static_cast<std::size_t>(random.below(9))) =
          random.below(2) ? std::numeric_limits<T>::quiet_NaN()
                          : static_cast<T>(random.sign()) * std::numeric_limits<T>::infinity();
  }
  return A;
}

template <class T>
bool same_bits(T a, T b) {
  return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}

/// Lane i of `a` and lane j of `b` agree in every bit.
template <class T>
bool same_lane(const Decomposition<T>& a, std::size_t i, const Decomposition<T>& b, std::size_t j) {
  bool same = true;
  for (std::size_t k = 0; k < 9; ++k)
    same = same && same_bits(a.U(i, k), b.U(j, k)) && same_bits(a.V(i, k), b.V(j, k));
  for (std::size_t k = 0; k < 3; ++k) same = same && same_bits(a.sigma(i, k), b.sigma(j, k));
  return same;
}

template <class T>
void check_independence() {
  const std::size_t n = 4003;  // no multiple of any lane count
  const Packed<T> A = mixture<T>(n, 11);
  const auto& table = kernels::batch_kernels<T>();
  const auto staged = decompose(A, table.svd);
  const auto plain = decompose(A, table.svd_plain), scalar = decompose(A, table.svd_scalar);
  for (std::size_t i = 0; i < n; ++i) {
    ASSERT_TRUE(same_lane(staged, i, plain, i)) << i;
    ASSERT_TRUE(same_lane(staged, i, scalar, i)) << i;
  }
  // Other neighbours, other lanes.
  Random random(12);
  std::vector<std::size_t> place(n);
  for (std::size_t i = 0; i < n; ++i) place[i] = i;
  for (std::size_t i = n; i > 1; --i)
    std::swap(place[i - 1], place[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
  Packed<T> B(n, 9);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < 9; ++k) B(place[i], k) = A(i, k);
  const auto moved = decompose(B, table.svd);
  for (std::size_t i = 0; i < n; ++i) ASSERT_TRUE(same_lane(staged, i, moved, place[i])) << i;
}

TEST_P(SvdKernel, LanesNeverSeeEachOther) {
  check_independence<float>();
  check_independence<double>();
}

/// NaN or infinity anywhere: NaN everywhere in that lane. (Neighbours: the test above.)
template <class T>
void check_not_a_number() {
  const T inf = std::numeric_limits<T>::infinity(), nan = std::numeric_limits<T>::quiet_NaN();
  std::vector<std::array<T, 9>> cases = {{inf, inf, inf, inf, inf, inf, inf, inf, inf},
                                         {nan, nan, nan, nan, nan, nan, nan, nan, nan},
                                         {inf, 0, 0, 0, -inf, 0, 0, 0, 1}};
  for (std::size_t k = 0; k < 9; ++k)
    for (T bad : {inf, -inf, nan})
      for (T rest :
           {T(0), T(1), std::numeric_limits<T>::max(), std::numeric_limits<T>::denorm_min()}) {
        std::array<T, 9> a;
        a.fill(rest);
        a[k] = bad;
        cases.push_back(a);
      }
  Packed<T> A(cases.size(), 9);
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (std::size_t k = 0; k < 9; ++k) A(i, k) = cases[i][k];
  const auto r = decompose(A, kernels::batch_kernels<T>().svd);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    for (std::size_t k = 0; k < 9; ++k)
      ASSERT_TRUE(std::isnan(r.U(i, k)) && std::isnan(r.V(i, k))) << i;
    for (std::size_t k = 0; k < 3; ++k) ASSERT_TRUE(std::isnan(r.sigma(i, k))) << i;
  }
}

TEST_P(SvdKernel, NotANumberStaysInItsLane) {
  check_not_a_number<float>();
  check_not_a_number<double>();
}

FIRN_ON_EVERY_TARGET(SvdKernel);

}  // namespace
}  // namespace firn::verification
