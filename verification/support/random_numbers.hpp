// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Random numbers, the same on every machine, unlike the distributions of the standard library.
/// Without Eigen, for tests of code that has none.

#include <cmath>
#include <cstdint>

#include "firn/random.hpp"

namespace firn::fixtures {

/// Distributions over the 64-bit words of an engine.
template <class Engine>
class NumbersOf {
 public:
  explicit NumbersOf(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  /// In [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in the logarithm; 0 < low < high.
  double log_uniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  /// In [−1, 1).
  double operator()() { return static_cast<double>(bits() >> 11) * 0x1p-52 - 1; }

  bool chance(double probability) { return uniform() < probability; }
  double sign() { return (bits() & 1) ? 1 : -1; }
  /// 0 … n − 1.
  int below(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }
  /// low … high, both included.
  int integer(int low, int high) { return low + static_cast<int>(uniform() * (high - low + 1)); }
  /// Normal, by Box and Muller.
  double gaussian() {
    const double r = std::sqrt(-2 * std::log(1 - uniform()));
    return r * std::cos(6.283185307179586 * uniform());
  }

 private:
  Engine engine_;
};

/// SplitMix64 (Steele, Lea, Flood 2014).
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  std::uint64_t operator()() { return mix_bits(state_ += 0x9e3779b97f4a7c15ull); }

 private:
  std::uint64_t state_;
};

/// Word n is the hash of the seed and n, as in `uniform(seed, {n})`.
class HashedCount {
 public:
  explicit HashedCount(std::uint64_t seed) : seed_(seed) {}
  std::uint64_t operator()() { return hash_words(seed_, {count_++}); }

 private:
  std::uint64_t seed_;
  std::int64_t count_ = 0;
};

}  // namespace firn::fixtures
