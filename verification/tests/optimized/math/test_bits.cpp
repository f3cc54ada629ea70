// SPDX-License-Identifier: BSD-3-Clause
// The same bits from every kernel, on every instruction set with a fused multiply-add, from g++ and
// from clang: fingerprints of the results of a sample that needs no mathematical library.

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>

#include "verification/oracles/processor.hpp"
#include "verification/oracles/svd_families.hpp"
#include "verification/tests/optimized/math/kernel_fixture.hpp"

namespace firn::verification {
namespace {

/// 64-bit FNV-1a over the bits; all NaNs count as alike.
template <class T>
void mix(std::uint64_t& hash, const Packed<T>& values) {
  for (T x : values.values()) {
    if (std::isnan(x)) x = std::numeric_limits<T>::max();
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &x, sizeof x);
    for (unsigned char b : bytes) hash = (hash ^ b) * 0x100000001b3ull;
  }
}

constexpr std::uint64_t seed_of_hash = 0xcbf29ce484222325ull;
constexpr std::size_t count = 8192;

/// Sums of products of random integers and powers of two: exact in long double, rounded once to T.
template <class T>
Packed<T> sample(std::uint64_t seed, bool strains) {
  Random random(seed);
  Packed<T> A(count, 9);
  for (std::size_t i = 0; i < count; ++i) {
    const int kind = static_cast<int>(i % 8);
    const int scale = kind == 6 ? random.below(100) - 60 : 0;
    for (std::size_t k = 0; k < 9; ++k) {
      const long double u = random.uniform(-1, 1);
      long double a = kind < 2   ? 0.0625L * u          // snow
                      : kind < 4 ? u                    // anything
                      : kind < 5 ? random.below(3) - 1  // small integers
                      : kind < 7 ? std::ldexp(u, scale - (k % 3 ? random.below(30) : 0))  // mixed
                                 : std::ldexp(u, -random.below(20));
      if (!strains && kind < 2 && k % 4 == 0) a += 1;
      if (kind == 7 && k == i / 8 % 9 && i % 5 == 0) a = std::numeric_limits<double>::quiet_NaN();
      A(i, k) = static_cast<T>(a);
    }
  }
  return A;
}

/// No instruction set of the processor goes untested because it was not built or not noticed.
TEST(KernelTargets, EverythingThatTheProcessorHasIsTested) {
  std::vector<std::string> tested;
  for (const auto target : hwy::SupportedAndGeneratedTargets())
    tested.push_back(hwy::TargetName(target));
  for (const std::string& name : instruction_sets_of_the_processor())
    EXPECT_EQ(std::count(tested.begin(), tested.end(), name), 1) << name;
}

class KernelBits : public EveryTarget {
 protected:
  void SetUp() override {
    EveryTarget::SetUp();
    if (!fused()) GTEST_SKIP() << "MulAdd rounds twice on this target";
  }
};

template <class T>
std::uint64_t svd_bits() {
  const Packed<T> A = sample<T>(1, false);
  Packed<T> U(count, 9), sigma(count, 3), V(count, 9), R(count, 9);
  const auto& kernel = kernels::batch_kernels<T>();
  kernel.svd(A.data(), U.data(), sigma.data(), V.data(), A.packets());
  kernel.polar_near_rotation(A.data(), R.data(), A.packets());
  std::uint64_t hash = seed_of_hash;
  mix(hash, U), mix(hash, sigma), mix(hash, V), mix(hash, R);
  return hash;
}

template <class T>
std::uint64_t elastic_bits() {
  const Packed<T> D = sample<T>(2, true);
  Packed<T> mu(count, 1), lambda(count, 1), tau(count, 6), inside(count, 1), y(count, 1);
  for (std::size_t i = 0; i < count; ++i)
    mu(i, 0) = static_cast<T>(1 + i % 3), lambda(i, 0) = static_cast<T>(i % 5);
  const auto& kernel = kernels::batch_kernels<T>();
  const auto box = kernels::ElasticBox<T>::from(2.5e-2, 7.5e-3);
  kernel.kirchhoff_stress(D.data(), mu.data(), lambda.data(), tau.data(), D.packets());
  kernel.inside_elastic_box(D.data(), box, inside.data(), D.packets());
  Packed<T> x(count, 1);
  for (std::size_t i = 0; i < count; ++i) x(i, 0) = 16 * D(i, i % 9);
  kernel.exp(x.data(), y.data(), x.packets());
  std::uint64_t hash = seed_of_hash;
  mix(hash, tau), mix(hash, inside), mix(hash, y);
  Packed<T> factors(count, 15), action(count, 9);
  kernel.hessian_factors(D.data(), mu.data(), lambda.data(), factors.data(), D.packets());
  kernel.hessian_action(factors.data(), sample<T>(5, true).data(), action.data(), D.packets());
  mix(hash, factors), mix(hash, action);
  return hash;
}

template <class T>
std::uint64_t return_map_bits() {
  Packed<T> E = sample<T>(3, true), P = sample<T>(4, true), changed(count, 1);
  const auto box = kernels::ElasticBox<T>::from(2.5e-2, 7.5e-3);
  kernels::batch_kernels<T>().return_map(box, E.data(), P.data(), changed.data(), E.packets());
  std::uint64_t hash = seed_of_hash;
  mix(hash, E), mix(hash, P), mix(hash, changed);
  return hash;
}

// The numbers were printed by g++ 12 and by clang 14 alike. They change when a kernel's arithmetic
// changes, on purpose or not: then both compilers must agree on the new ones.
TEST_P(KernelBits, Decomposition) {
  EXPECT_EQ(svd_bits<float>(), 11185071907604903714u);
  EXPECT_EQ(svd_bits<double>(), 8301763704774863648u);
}

TEST_P(KernelBits, StressBoxExponentialHessian) {
  EXPECT_EQ(elastic_bits<float>(), 6625891450184186829u);
  EXPECT_EQ(elastic_bits<double>(), 5229235676508319979u);
}

TEST_P(KernelBits, ReturnMap) {
  EXPECT_EQ(return_map_bits<float>(), 8893881282466083751u);
  EXPECT_EQ(return_map_bits<double>(), 15789719279069256672u);
}

FIRN_ON_EVERY_TARGET(KernelBits);

}  // namespace
}  // namespace firn::verification
