// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A signed distance known at the points of a dense grid: what meshes and
/// level-set files become. Plain arrays, no library.

#include <array>
#include <vector>

#include "firn/shape.hpp"

namespace firn {

/// Distances φ at origin + spacing·(i,j,k), trilinear in between.
///
/// The solid {φ ≤ 0} lies strictly inside the grid's box, so beyond the box the
/// distance continues as √(φ(q)² + ‖x − q‖²) with q the box's nearest point.
/// That is continuous, right to first order far away, and never more than the
/// true distance: for a point y of a convex box ‖x−y‖² ≥ ‖x−q‖² + ‖q−y‖².
class SampledDistance {
 public:
  /// phi[(i·size[1] + j)·size[2] + k], k fastest [m]. Throws std::invalid_argument
  /// for sizes below 2, a wrong number of values, a value that is not finite, or
  /// a value ≤ 0 on the border.
  SampledDistance(const Vec3& origin, double spacing, const std::array<int, 3>& size,
                  std::vector<float> phi);

  /// φ(x) [m].
  double distance(const Vec3& x) const;

  /// ∇φ at x, exactly that of distance(); zero where the samples are flat.
  Vec3 gradient(const Vec3& x) const;

  /// Exact bounds of {φ ≤ 0} as interpolated; min > max if there is no such point.
  const Bounds& solid_bounds() const { return solid_; }

  /// Bounds of the sample points.
  const Bounds& box() const { return box_; }

  /// Upper bound of ‖∇φ‖, at least 1 (the slope outside the box).
  double lipschitz_bound() const { return lipschitz_; }

  double spacing() const { return spacing_; }
  const std::array<int, 3>& size() const { return size_; }
  const std::vector<float>& values() const { return phi_; }

 private:
  struct Cell;  // a grid cell with its eight values and the place of x in it

  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * size_[1] + j) * size_[2] + k;
  }
  Cell cell_at(const Vec3& x) const;
  void require_border_outside() const;
  Bounds find_solid_bounds() const;
  double find_lipschitz_bound() const;

  double spacing_;
  std::array<int, 3> size_;
  std::vector<float> phi_;
  Bounds box_, solid_;
  double lipschitz_;
};

}  // namespace firn
