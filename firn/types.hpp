// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The few types that every part of Firn uses. SI units throughout.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

namespace firn {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// Index i = (i,j,k) of a grid node. The node sits at origin + h·(i,j,k).
struct NodeIndex {
  std::int32_t i = 0, j = 0, k = 0;

  friend bool operator==(const NodeIndex& a, const NodeIndex& b) {
    return a.i == b.i && a.j == b.j && a.k == b.k;
  }
  /// Lexicographic: the order in which Solver::store() lists nodes.
  friend bool operator<(const NodeIndex& a, const NodeIndex& b) {
    return std::tie(a.i, a.j, a.k) < std::tie(b.i, b.j, b.k);
  }
};

enum class Precision { float64, float32 };

}  // namespace firn
