// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/triangle_tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace firn {

double distance_squared(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto to_segment = [&](const Vec3& p, const Vec3& q) {
    const Vec3 d = q - p;
    const double length_squared = d.squaredNorm();
    const double s = length_squared > 0 ? (x - p).dot(d) / length_squared : 0;
    return (x - (p + std::min(std::max(s, 0.0), 1.0) * d)).squaredNorm();
  };
  const double to_edges = std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});

  // The foot on the plane counts if its barycentric coordinates are positive.
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const double d11 = ab.dot(ab), d12 = ab.dot(ac), d22 = ac.dot(ac);
  const double e1 = ab.dot(ax), e2 = ac.dot(ax);
  const double determinant = d11 * d22 - d12 * d12;
  const double u = d22 * e1 - d12 * e2, v = d11 * e2 - d12 * e1;
  if (!(determinant > 0 && u > 0 && v > 0 && u + v < determinant)) return to_edges;
  return std::min(to_edges, (ax - (u / determinant) * ab - (v / determinant) * ac).squaredNorm());
}

Vec3 nearest_point(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double size = n.squaredNorm();
  if (size > 0) {
    const Vec3 foot = x - (x - a).dot(n) / size * n;
    const auto side = [&](const Vec3& p, const Vec3& q) {
      return (q - p).cross(foot - p).dot(n) >= 0;
    };
    if (side(a, b) && side(b, c) && side(c, a)) return foot;
  }
  Vec3 nearest = a;
  for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    const Vec3 d = q - p;
    const double length_squared = d.squaredNorm();
    const double s = length_squared > 0 ? (x - p).dot(d) / length_squared : 0;
    const Vec3 foot = p + std::min(std::max(s, 0.0), 1.0) * d;
    if ((x - foot).squaredNorm() < (x - nearest).squaredNorm()) nearest = foot;
  }
  return nearest;
}

namespace {

/// True if the ray from x along d enters the box before `reach`.
bool meets(const Vec3& x, const Vec3& d, double reach, const Bounds& box) {
  double enter = 0, leave = reach;
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0) {
      if (x[axis] < box.min[axis] || x[axis] > box.max[axis]) return false;
      continue;
    }
    const double s1 = (box.min[axis] - x[axis]) / d[axis];
    const double s2 = (box.max[axis] - x[axis]) / d[axis];
    enter = std::max(enter, std::min(s1, s2));
    leave = std::min(leave, std::max(s1, s2));
  }
  return enter <= leave;
}

/// Distance along d at which the ray from x meets abc; negative if it does not
/// (Möller and Trumbore 1997).
double distance_along(const Vec3& x, const Vec3& d, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, p = d.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0) return -1;
  const Vec3 ax = x - a, q = ax.cross(ab);
  const double u = ax.dot(p) / determinant, v = d.dot(q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 ? ac.dot(q) / determinant : -1;
}

double distance_squared(const Vec3& x, const Bounds& box) {
  return (box.min - x).cwiseMax(x - box.max).cwiseMax(0.0).squaredNorm();
}

constexpr std::int32_t leaf_size = 4;

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(mesh.triangles.size());
  if (!order_.empty()) build(0, static_cast<std::int32_t>(order_.size()));
}

Bounds TriangleTree::box_of(std::int32_t first, std::int32_t count) const {
  const Vec3& any = mesh_.vertices[mesh_.triangles[order_[first]][0]];
  Bounds box{any, any};
  for (std::int32_t t = first; t < first + count; ++t)
    for (const std::int32_t corner : mesh_.triangles[order_[t]]) {
      box.min = box.min.cwiseMin(mesh_.vertices[corner]);
      box.max = box.max.cwiseMax(mesh_.vertices[corner]);
    }
  return box;
}

/// Halves the triangles at the median of their centres along the longest side.
std::int32_t TriangleTree::build(std::int32_t first, std::int32_t count) {
  const auto node = static_cast<std::int32_t>(nodes_.size());
  nodes_.push_back({box_of(first, count), first, count});
  if (count <= leaf_size) return node;

  int axis = 0;
  (nodes_[node].box.max - nodes_[node].box.min).maxCoeff(&axis);
  const auto centre = [&](std::int32_t t) {
    const Triangle& c = mesh_.triangles[t];
    return mesh_.vertices[c[0]][axis] + mesh_.vertices[c[1]][axis] + mesh_.vertices[c[2]][axis];
  };
  const std::int32_t half = count / 2;
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + half, begin + count,
                   [&](std::int32_t a, std::int32_t b) { return centre(a) < centre(b); });
  build(first, half);
  const std::int32_t second = build(first + half, count - half);
  nodes_[node].first = second;
  nodes_[node].count = 0;
  return node;
}

double TriangleTree::distance_squared_to(std::int32_t triangle, const Vec3& x) const {
  const auto& [a, b, c] = mesh_.triangles[triangle];
  return firn::distance_squared(x, mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]);
}

double TriangleTree::distance(const Vec3& x, std::int32_t& nearest) const {
  Found found{std::numeric_limits<double>::infinity(), -1};
  if (nearest >= 0) found = {distance_squared_to(nearest, x), nearest};
  if (!nodes_.empty()) search(0, x, found);
  nearest = found.triangle;
  return std::sqrt(found.distance_squared);
}

void TriangleTree::search(std::int32_t index, const Vec3& x, Found& found) const {
  const Node& node = nodes_[index];
  if (node.count > 0) {
    for (std::int32_t t = node.first; t < node.first + node.count; ++t) {
      const double squared = distance_squared_to(order_[t], x);
      if (squared < found.distance_squared) found = {squared, order_[t]};
    }
    return;
  }
  std::array<std::int32_t, 2> child{index + 1, node.first};
  std::array<double, 2> gap{distance_squared(x, nodes_[child[0]].box),
                            distance_squared(x, nodes_[child[1]].box)};
  if (gap[1] < gap[0]) {
    std::swap(child[0], child[1]);
    std::swap(gap[0], gap[1]);
  }
  for (int side = 0; side < 2; ++side)
    if (gap[side] < found.distance_squared) search(child[side], x, found);
}

TriangleTree::Hit TriangleTree::first_hit(const Vec3& x, const Vec3& d, double reach,
                                          std::int32_t skipped) const {
  Hit hit{-1, reach};
  if (!nodes_.empty()) cast(0, x, d, skipped, hit);
  return hit;
}

void TriangleTree::cast(std::int32_t index, const Vec3& x, const Vec3& d, std::int32_t skipped,
                        Hit& hit) const {
  const Node& node = nodes_[index];
  if (!meets(x, d, hit.distance, node.box)) return;
  for (std::int32_t t = node.first; t < node.first + node.count; ++t) {
    if (order_[t] == skipped) continue;
    const auto& [a, b, c] = mesh_.triangles[order_[t]];
    const double s = distance_along(x, d, mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]);
    if (s >= 0 && s < hit.distance) hit = {order_[t], s};
  }
  if (node.count > 0) return;
  cast(index + 1, x, d, skipped, hit);
  cast(node.first, x, d, skipped, hit);
}

}  // namespace firn
