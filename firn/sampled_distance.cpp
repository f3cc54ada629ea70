// SPDX-License-Identifier: BSD-3-Clause
#include "firn/sampled_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace firn {

/// The trilinear interpolant around one point.
struct SampledDistance::Cell {
  std::array<double, 8> phi{};  // corner (a,b,c) at 4a + 2b + c
  Vec3 s;                       // place in the cell, in [0, 1]³

  static double lerp(double a, double b, double s) { return a + s * (b - a); }

  double value() const {
    std::array<double, 4> along_z{};
    for (int ab = 0; ab < 4; ++ab) along_z[ab] = lerp(phi[2 * ab], phi[2 * ab + 1], s[2]);
    return lerp(lerp(along_z[0], along_z[1], s[1]), lerp(along_z[2], along_z[3], s[1]), s[0]);
  }

  /// ∂/∂s_axis: the differences along the four edges of that direction, interpolated.
  double slope(int axis) const {
    const int step = 4 >> axis;
    const int axis_1 = axis == 0 ? 1 : 0, axis_2 = axis == 2 ? 1 : 2;
    const int step_1 = 4 >> axis_1, step_2 = 4 >> axis_2;
    const auto edge = [&](int corner) { return phi[corner + step] - phi[corner]; };
    return lerp(lerp(edge(0), edge(step_1), s[axis_1]),
                lerp(edge(step_2), edge(step_1 + step_2), s[axis_1]), s[axis_2]);
  }
};

SampledDistance::SampledDistance(const Vec3& origin, double spacing, const std::array<int, 3>& size,
                                 std::vector<float> phi)
    : spacing_(spacing), size_(size), phi_(std::move(phi)) {
  if (!(spacing > 0) || !std::isfinite(spacing) || !origin.allFinite())
    throw std::invalid_argument("sampled distance: spacing and origin must be finite");
  std::size_t count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (size[axis] < 2) throw std::invalid_argument("sampled distance: fewer than 2 points");
    count *= static_cast<std::size_t>(size[axis]);
    box_.min[axis] = origin[axis];
    box_.max[axis] = origin[axis] + spacing * (size[axis] - 1);
  }
  if (count != phi_.size()) throw std::invalid_argument("sampled distance: wrong number of values");
  if (!std::all_of(phi_.begin(), phi_.end(), [](float value) { return std::isfinite(value); }))
    throw std::invalid_argument("sampled distance: a value is not finite");
  require_border_outside();
  solid_ = find_solid_bounds();
  lipschitz_ = find_lipschitz_bound();
}

void SampledDistance::require_border_outside() const {
  for (int i = 0; i < size_[0]; ++i)
    for (int j = 0; j < size_[1]; ++j) {
      const bool border = i == 0 || i == size_[0] - 1 || j == 0 || j == size_[1] - 1;
      for (int k = 0; k < size_[2]; k += border ? 1 : size_[2] - 1)
        if (!(phi_[index(i, j, k)] > 0))
          throw std::invalid_argument("sampled distance: the solid reaches the border of its grid");
    }
}

/// For a fixed coordinate along one axis the interpolant is bilinear in the two
/// others, so its least value over a cell lies on one of the four edges: the
/// zeros on the edges along an axis bound the solid along that axis exactly.
Bounds SampledDistance::find_solid_bounds() const {
  const double infinity = std::numeric_limits<double>::infinity();
  Bounds solid{Vec3::Constant(infinity), Vec3::Constant(-infinity)};
  const std::array<std::size_t, 3> stride{index(1, 0, 0), index(0, 1, 0), 1};
  for (int i = 1; i < size_[0] - 1; ++i)
    for (int j = 1; j < size_[1] - 1; ++j)
      for (int k = 1; k < size_[2] - 1; ++k) {
        const std::size_t here = index(i, j, k);
        const double phi = phi_[here];
        if (phi > 0) continue;
        const std::array<int, 3> at{i, j, k};
        for (int axis = 0; axis < 3; ++axis) {
          const double x = box_.min[axis] + spacing_ * at[axis];
          const double before = phi_[here - stride[axis]], after = phi_[here + stride[axis]];
          const double low = before > 0 ? spacing_ * (phi / (phi - before)) : 0;
          const double high = after > 0 ? spacing_ * (phi / (phi - after)) : 0;
          solid.min[axis] = std::min(solid.min[axis], x - low);
          solid.max[axis] = std::max(solid.max[axis], x + high);
        }
      }
  return solid;
}

/// Each component of a cell's gradient is a mean of four edge differences, so
/// ‖∇φ‖² is at most the sum over the axes of the largest squared difference.
double SampledDistance::find_lipschitz_bound() const {
  double largest_squared = 0;
  Cell cell;
  for (int i = 0; i + 1 < size_[0]; ++i)
    for (int j = 0; j + 1 < size_[1]; ++j)
      for (int k = 0; k + 1 < size_[2]; ++k) {
        for (int corner = 0; corner < 8; ++corner)
          cell.phi[corner] =
              phi_[index(i + (corner >> 2), j + (corner >> 1 & 1), k + (corner & 1))];
        double squared = 0;
        for (int step = 1; step <= 4; step *= 2) {
          double steepest = 0;
          for (int corner = 0; corner < 8; ++corner)
            if (!(corner & step))
              steepest = std::max(steepest, std::abs(cell.phi[corner + step] - cell.phi[corner]));
          squared += steepest * steepest;
        }
        largest_squared = std::max(largest_squared, squared);
      }
  return std::max(1.0, std::sqrt(largest_squared) / spacing_);
}

SampledDistance::Cell SampledDistance::cell_at(const Vec3& x) const {
  Cell cell;
  std::array<int, 3> low{};
  for (int axis = 0; axis < 3; ++axis) {
    const double place = (x[axis] - box_.min[axis]) / spacing_;
    const double last = size_[axis] - 2;
    low[axis] = static_cast<int>(std::min(std::max(std::floor(place), 0.0), last));
    cell.s[axis] = std::min(std::max(place - low[axis], 0.0), 1.0);
  }
  for (int corner = 0; corner < 8; ++corner)
    cell.phi[corner] =
        phi_[index(low[0] + (corner >> 2), low[1] + (corner >> 1 & 1), low[2] + (corner & 1))];
  return cell;
}

double SampledDistance::distance(const Vec3& x) const {
  const double inside = cell_at(x).value();  // at q: cell_at() clamps to the box
  const Vec3 q = x.cwiseMax(box_.min).cwiseMin(box_.max);
  const double beyond = (x - q).norm();
  return beyond > 0 ? std::sqrt(inside * inside + beyond * beyond) : inside;
}

Vec3 SampledDistance::gradient(const Vec3& x) const {
  const Cell cell = cell_at(x);
  Vec3 gradient;
  for (int axis = 0; axis < 3; ++axis) gradient[axis] = cell.slope(axis) / spacing_;
  const Vec3 q = x.cwiseMax(box_.min).cwiseMin(box_.max);
  const Vec3 beyond = x - q;
  if (beyond.isZero(0)) return gradient;
  // q does not move along the axes on which it is clamped.
  const double inside = cell.value();
  for (int axis = 0; axis < 3; ++axis)
    gradient[axis] = beyond[axis] != 0 ? beyond[axis] : inside * gradient[axis];
  return gradient / std::sqrt(inside * inside + beyond.squaredNorm());
}

}  // namespace firn
