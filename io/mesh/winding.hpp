// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// How often closed surfaces wind around a point.

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "io/mesh/triangle_mesh.hpp"
#include "io/mesh/triangle_tree.hpp"

namespace firn {

/// Winding numbers of several closed surfaces, each turned alike (turn_alike()): the
/// triangles above a point, counted +1 where they turn counterclockwise seen from above
/// and −1 otherwise.
///
/// Whether a triangle lies above is decided in integers: coordinates are rounded to
/// multiples of the last bit of the largest one. A point below an edge or a vertex counts as
/// moved by (ε, ε²) along (x, y), with ε infinitely small, so it lies below exactly one of
/// the triangles there. On faces along the axes that makes min inside and max outside.
class WindingNumbers {
 public:
  explicit WindingNumbers(const std::vector<TriangleMesh>& parts);
  WindingNumbers(const WindingNumbers&) = delete;
  WindingNumbers& operator=(const WindingNumbers&) = delete;

  struct Around {
    std::int32_t part, winding;
  };

  /// The parts that wind around x, with their winding numbers, none of them 0.
  /// `around` is overwritten.
  void find(const Vec3& x, std::vector<Around>& around) const;

  /// All parts as one mesh, part by part.
  const TriangleMesh& surface() const { return surface_; }
  std::int32_t part_of(std::int32_t triangle) const { return part_of_[triangle]; }
  const TriangleTree& tree() const { return *tree_; }

 private:
  Vec3 rounded(const Vec3& x) const;
  int crossing(std::int32_t triangle, const Vec3& x) const;

  TriangleMesh surface_;
  std::vector<std::int32_t> part_of_;
  Bounds bounds_{};
  double quantum_ = 1;  // a power of 2
  std::optional<TriangleTree> tree_;
};

}  // namespace firn
