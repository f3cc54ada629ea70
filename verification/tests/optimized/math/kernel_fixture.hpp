// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Runs a test on every instruction set of this processor, and proves that it did.

#include <algorithm>
#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <hwy/highway.h>
#include <hwy/targets.h>
#include <limits>
#include <string>
#include <vector>

#include "optimized/math/batch.hpp"

namespace firn::verification {

/// Sample sizes stand for the everyday run; the programs labelled `long` multiply them.
#ifdef FIRN_LONG_TEST
inline constexpr std::size_t sample_factor = 100;
#else
inline constexpr std::size_t sample_factor = 1;
#endif

/// The unit in which errors are told.
template <class T>
inline constexpr long double roundoff = std::numeric_limits<T>::epsilon();

/// One test instance for each compiled instruction set that the processor has.
class EveryTarget : public ::testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override {
    hwy::SetSupportedTargetsForTest(GetParam());
    hwy::GetChosenTarget().DeInit();
    // The table carries the name that was compiled into it: no other set can have answered.
    ASSERT_STREQ(kernels::batch_kernels<float>().target, hwy::TargetName(GetParam()));
    ASSERT_STREQ(kernels::batch_kernels<double>().target, hwy::TargetName(GetParam()));
  }
  void TearDown() override {
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().DeInit();
  }
  /// Whether MulAdd rounds once here: then all such targets give the same bits.
  static bool fused() { return GetParam() != HWY_SSE4; }
};

inline std::string target_name(const ::testing::TestParamInfo<std::int64_t>& info) {
  return hwy::TargetName(info.param);
}

#define FIRN_ON_EVERY_TARGET(suite)       \
  INSTANTIATE_TEST_SUITE_P(Target, suite, \
                           ::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()), target_name)

/// An array in the packet layout of batch.hpp: component k of particle i.
template <class T>
class Packed {
 public:
  Packed(std::size_t count, std::size_t rows)
      : count_(count),
        rows_(rows),
        packets_((count + kernels::packet_size - 1) / kernels::packet_size),
        values_(packets_ * kernels::packet_size * rows) {}
  T& operator()(std::size_t i, std::size_t k) { return values_[index(i, k)]; }
  const T& operator()(std::size_t i, std::size_t k) const { return values_[index(i, k)]; }
  T* data() { return values_.data(); }
  const T* data() const { return values_.data(); }
  std::size_t size() const { return count_; }
  std::size_t rows() const { return rows_; }
  std::size_t packets() const { return packets_; }
  const std::vector<T>& values() const { return values_; }

 private:
  std::size_t index(std::size_t i, std::size_t k) const {
    return (i / kernels::packet_size * rows_ + k) * kernels::packet_size + i % kernels::packet_size;
  }
  std::size_t count_, rows_, packets_;
  std::vector<T> values_;
};

template <class T>
std::array<long double, 9> matrix(const Packed<T>& a, std::size_t i) {
  std::array<long double, 9> m;
  for (int k = 0; k < 9; ++k) m[k] = a(i, k);
  return m;
}

/// Rounds a matrix to T and puts it in place i.
template <class T>
void put(Packed<T>& a, std::size_t i, const std::array<long double, 9>& m) {
  for (int k = 0; k < 9; ++k) a(i, k) = static_cast<T>(m[k]);
}

/// Largest value and 99.9th percentile of a sample.
struct Spread {
  std::vector<double> values;
  void add(long double x) { values.push_back(static_cast<double>(x)); }
  double largest() const { return quantile(1); }
  double quantile(double q) const {
    if (values.empty()) return 0;
    std::vector<double> v = values;
    const auto k = static_cast<std::size_t>(q * static_cast<double>(v.size() - 1));
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(k), v.end());
    return v[k];
  }
};

}  // namespace firn::verification
