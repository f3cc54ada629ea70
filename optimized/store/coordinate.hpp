// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Positions inside a block as the store keeps them.

#include <bit>
#include <cmath>

#include "optimized/store/block_map.hpp"
#include "optimized/store/layout.hpp"

namespace firn::optimized {

/// Positions are int32 in float (layout.hpp), plain numbers in double.
template <class T>
struct Coordinate;
template <>
struct Coordinate<float> {
  using Number = std::int32_t;
  static constexpr Number one = fixed_one;
  static Number from(double x) { return static_cast<Number>(std::lround(x * fixed_one)); }
  static double cells(Number x) { return static_cast<double>(x) / fixed_one; }
};
template <>
struct Coordinate<double> {
  using Number = double;
  static constexpr Number one = 1;
  static Number from(double x) { return x; }
  static double cells(Number x) { return x; }
};

template <class T>
typename Coordinate<T>::Number number_of(T value) {
  return std::bit_cast<typename Coordinate<T>::Number>(value);
}

/// Blocks further out than this along an axis are refused: those around them must be numbered, too.
inline constexpr std::int32_t reachable_blocks = block_limit - 4;

}  // namespace firn::optimized
