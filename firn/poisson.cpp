// SPDX-License-Identifier: BSD-3-Clause
#include "firn/poisson.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "firn/error.hpp"
#include "firn/random.hpp"

namespace firn {

namespace {

/// Darts per radius³. Twice as many would bring the points only 2 % closer to
/// one another, in twice the time.
constexpr double darts_per_cubed_radius = 20;

using Cell = std::array<std::int64_t, 3>;

/// The points found so far, listed by cells of edge ≥ radius, so that a point's
/// neighbours within the radius are in the 27 cells around it.
class Background {
 public:
  Background(const Bounds& box, const Vec3& period, double radius)
      : low_(box.min), period_(period), radius_(radius) {
    double count = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const bool open = !(period[axis] > 0);
      const double along = open ? std::ceil((box.max[axis] - box.min[axis]) / radius)
                                : std::floor(period[axis] / radius);
      if (!open && along < 3)  // else a cell would be its own neighbour twice
        throw InputError("body", "period in Poisson-disk radii", to_text(along), "at least 3");
      count *= along;
      if (!(count <= 5e8))  // some 60 GB of particles
        throw InputError("body", "Poisson-disk cells within its bounds", to_text(count),
                         "at most 5e8");
      cells_[axis] = static_cast<std::int64_t>(along);
      edge_[axis] = open ? radius : period[axis] / along;
    }
    first_.assign(static_cast<std::size_t>(count), -1);
  }

  const Cell& cells() const { return cells_; }
  double cell_volume() const { return edge_[0] * edge_[1] * edge_[2]; }

  /// Position in a cell at the fractions u of its edges.
  Vec3 place(const Cell& cell, const Vec3& u) const {
    Vec3 x;
    for (int axis = 0; axis < 3; ++axis)
      x[axis] = low_[axis] + edge_[axis] * (static_cast<double>(cell[axis]) + u[axis]);
    return x;
  }

  /// Keeps the dart x, which fell into `cell`, if no point lies within the radius.
  void offer(const Cell& cell, const Vec3& x) {
    if (crowded(cell, x)) return;  // where most darts fail
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
      Cell near{cell[0] + neighbour / 9 - 1, cell[1] + neighbour / 3 % 3 - 1,
                cell[2] + neighbour % 3 - 1};
      if (neighbour != 13 && on_grid(near) && crowded(near, x)) return;
    }
    next_.push_back(first_[index(cell)]);
    first_[index(cell)] = static_cast<std::int32_t>(points_.size());
    points_.push_back(x);
  }

  /// The points cell by cell.
  std::vector<Vec3> sorted() const {
    std::vector<Vec3> sorted;
    sorted.reserve(points_.size());
    for (const std::int32_t first : first_)
      for (std::int32_t p = first; p >= 0; p = next_[p]) sorted.push_back(points_[p]);
    return sorted;
  }

 private:
  std::size_t index(const Cell& cell) const {
    return static_cast<std::size_t>((cell[0] * cells_[1] + cell[1]) * cells_[2] + cell[2]);
  }

  /// Wraps a cell along periodic axes; false where it lies outside.
  bool on_grid(Cell& cell) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (period_[axis] > 0) cell[axis] = (cell[axis] + cells_[axis]) % cells_[axis];
      if (cell[axis] < 0 || cell[axis] >= cells_[axis]) return false;
    }
    return true;
  }

  bool crowded(const Cell& cell, const Vec3& x) const {
    for (std::int32_t p = first_[index(cell)]; p >= 0; p = next_[p])
      if (distance_squared(x, points_[p]) < radius_ * radius_) return true;
    return false;
  }

  /// ‖a − b‖², between nearest images along periodic axes.
  double distance_squared(const Vec3& a, const Vec3& b) const {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      double d = std::abs(a[axis] - b[axis]);
      if (period_[axis] > 0) d = std::min(d, period_[axis] - d);
      sum += d * d;
    }
    return sum;
  }

  Vec3 low_, period_;
  Vec3 edge_ = Vec3::Zero();
  double radius_;
  Cell cells_{};
  std::vector<Vec3> points_;
  std::vector<std::int32_t> next_;   // of a point: the one kept before it in its cell, or −1
  std::vector<std::int32_t> first_;  // of a cell: the point kept last, or −1
};

}  // namespace

const double poisson_disk_density = 0.5727;

std::vector<Vec3> poisson_disk(const Bounds& box, const Vec3& period, double radius,
                               std::uint64_t seed) {
  Background kept(box, period, radius);
  const auto rounds =
      std::llround(darts_per_cubed_radius * kept.cell_volume() / (radius * radius * radius));
  Cell cell;
  for (std::int64_t round = 0; round < rounds; ++round)
    for (cell[0] = 0; cell[0] < kept.cells()[0]; ++cell[0])
      for (cell[1] = 0; cell[1] < kept.cells()[1]; ++cell[1])
        for (cell[2] = 0; cell[2] < kept.cells()[2]; ++cell[2]) {
          const std::uint64_t dart = hash_words(seed, {cell[0], cell[1], cell[2], round});
          kept.offer(
              cell, kept.place(cell, {uniform(dart, {0}), uniform(dart, {1}), uniform(dart, {2})}));
        }
  return kept.sorted();
}

}  // namespace firn
