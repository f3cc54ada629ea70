// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Exact distance to a set of triangles: a tree of bounding boxes.

#include <vector>

#include "io/mesh/triangle_mesh.hpp"

namespace firn {

/// ‖x − y‖² to the nearest point y of the triangle abc, also where it is
/// degenerate (Ericson, Real-Time Collision Detection, §5.1.5).
double distance_squared(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

/// The point of the triangle abc nearest to x.
Vec3 nearest_point(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

class TriangleTree {
 public:
  /// The mesh must outlive the tree.
  explicit TriangleTree(const TriangleMesh& mesh);

  /// Distance from x to the nearest triangle; infinite if there is none [m].
  /// `nearest`, if not negative, is a triangle likely to be near, such as the
  /// answer for a point next to x: the better the guess, the faster the search.
  /// It becomes the triangle found.
  double distance(const Vec3& x, std::int32_t& nearest) const;

  /// Calls visit(triangle) for every triangle whose box meets the ray from x along +z.
  template <class Visit>
  void for_each_above(const Vec3& x, Visit visit) const {
    if (!nodes_.empty()) visit_above(0, x, visit);
  }

  struct Hit {
    std::int32_t triangle = -1;  ///< −1: none
    double distance = 0;         ///< [m]
  };

  /// The first triangle other than `skipped` that the ray from x along the unit vector d
  /// meets within `reach`. A ray through an edge may pass between the triangles there.
  Hit first_hit(const Vec3& x, const Vec3& d, double reach, std::int32_t skipped) const;

 private:
  struct Node {
    Bounds box;
    std::int32_t first, count;  // leaf: triangles; inner: count = 0, `first` the second child
  };

  std::int32_t build(std::int32_t first, std::int32_t count);
  Bounds box_of(std::int32_t first, std::int32_t count) const;
  double distance_squared_to(std::int32_t triangle, const Vec3& x) const;

  struct Found {
    double distance_squared;
    std::int32_t triangle;
  };
  void search(std::int32_t node, const Vec3& x, Found& found) const;

  template <class Visit>
  void visit_above(std::int32_t index, const Vec3& x, Visit& visit) const {
    const Node& node = nodes_[index];
    const Bounds& box = node.box;
    if (x[0] < box.min[0] || x[0] > box.max[0] || x[1] < box.min[1] || x[1] > box.max[1] ||
        x[2] > box.max[2])
      return;
    for (std::int32_t t = node.first; t < node.first + node.count; ++t) visit(order_[t]);
    if (node.count > 0) return;
    visit_above(index + 1, x, visit);
    visit_above(node.first, x, visit);
  }
  void cast(std::int32_t node, const Vec3& x, const Vec3& d, std::int32_t skipped, Hit& hit) const;

  const TriangleMesh& mesh_;
  std::vector<std::int32_t> order_;  // triangles, so that every leaf's are neighbours
  std::vector<Node> nodes_;          // a node's first child follows it
};

}  // namespace firn
