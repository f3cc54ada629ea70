// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/polygon.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace firn {

namespace {

/// A polygon seen along its mean normal, counterclockwise.
class FlatPolygon {
 public:
  FlatPolygon(const std::vector<Vec3>& vertices, const std::vector<std::int32_t>& corners) {
    // Newell's normal: the sum over the triangles of any fan.
    Vec3 normal = Vec3::Zero();
    const Vec3& origin = vertices[corners[0]];
    for (std::size_t c = 1; c + 1 < corners.size(); ++c)
      normal += (vertices[corners[c]] - origin).cross(vertices[corners[c + 1]] - origin);
    int away = 0;
    normal.cwiseAbs().maxCoeff(&away);
    int u = (away + 1) % 3, v = (away + 2) % 3;
    if (normal[away] < 0) std::swap(u, v);
    double size = 0;
    for (const std::int32_t corner : corners) {
      const Vec3 x = vertices[corner] - origin;
      points_.push_back({x[u], x[v]});
      size = std::max(size, x.cwiseAbs().maxCoeff());
    }
    roundoff_ = 1e-15 * size * size;
  }

  std::size_t size() const { return points_.size(); }

  /// Twice the area of the triangle, negative if it turns clockwise; 0 within roundoff.
  double area(std::size_t a, std::size_t b, std::size_t c) const {
    const Point ab = points_[b] - points_[a], ac = points_[c] - points_[a];
    const double area = ab[0] * ac[1] - ab[1] * ac[0];
    return std::abs(area) > roundoff_ ? area : 0;
  }

  bool same_place(std::size_t a, std::size_t b) const { return points_[a] == points_[b]; }

  /// No corner turns right, and all of them together turn once.
  bool is_convex() const {
    double turned = 0;
    for (std::size_t b = 0; b < size(); ++b) {
      const std::size_t a = b > 0 ? b - 1 : size() - 1, c = b + 1 < size() ? b + 1 : 0;
      if (area(a, b, c) < 0) return false;
      const Point in = points_[b] - points_[a], out = points_[c] - points_[b];
      turned += std::atan2(std::max(in[0] * out[1] - in[1] * out[0], 0.0), in.dot(out));
    }
    return turned < 3 * std::numbers::pi;
  }

 private:
  using Point = Eigen::Vector2d;
  std::vector<Point> points_;
  double roundoff_;
};

/// The corners not yet cut off, as a ring.
class Ears {
 public:
  explicit Ears(const FlatPolygon& polygon) : polygon_(polygon), left_(polygon.size()) {
    for (std::size_t c = 0; c < left_; ++c) {
      next_.push_back(c + 1 < left_ ? c + 1 : 0);
      last_.push_back(c > 0 ? c - 1 : left_ - 1);
    }
  }

  /// Calls visit(a, b, c) for the triangles of all ears. False if some corners cannot be cut.
  template <class Visit>
  bool cut(Visit visit) {
    std::size_t b = 0, refused = 0;
    bool may_touch = false;  // first only ears that touch no other corner
    while (left_ > 3) {
      if (is_ear(b, may_touch)) {
        visit(last_[b], b, next_[b]);
        next_[last_[b]] = next_[b];
        last_[next_[b]] = last_[b];
        --left_;
        b = last_[b];
        refused = 0;
        may_touch = false;
      } else {
        b = next_[b];
        if (++refused < left_) continue;
        if (may_touch) return cut_line(b, visit);
        may_touch = true;
        refused = 0;
      }
    }
    visit(last_[b], b, next_[b]);
    return polygon_.area(last_[b], b, next_[b]) >= 0;
  }

 private:
  bool is_ear(std::size_t b, bool may_touch) const {
    const std::size_t a = last_[b], c = next_[b];
    if (!(polygon_.area(a, b, c) > 0)) return false;
    for (std::size_t d = next_[c]; d != a; d = next_[d]) {
      if (polygon_.same_place(d, a) || polygon_.same_place(d, b) || polygon_.same_place(d, c))
        continue;  // the other end of a bridge
      const double ab = polygon_.area(a, b, d), bc = polygon_.area(b, c, d),
                   ca = polygon_.area(c, a, d);
      if (may_touch ? ab > 0 && bc > 0 && ca > 0 : ab >= 0 && bc >= 0 && ca >= 0) return false;
    }
    return true;
  }

  /// What is left if all its corners lie on one line: triangles without area.
  template <class Visit>
  bool cut_line(std::size_t a, Visit& visit) {
    for (std::size_t b = next_[a]; next_[b] != a; b = next_[b]) {
      if (polygon_.area(a, b, next_[b]) != 0) return false;
      visit(a, b, next_[b]);
    }
    return true;
  }

  const FlatPolygon& polygon_;
  std::size_t left_;
  std::vector<std::size_t> next_, last_;
};

}  // namespace

bool append_polygon(const std::vector<Vec3>& vertices, const std::vector<std::int32_t>& corners,
                    std::vector<Triangle>& triangles) {
  const std::size_t before = triangles.size();
  const auto append = [&](std::size_t a, std::size_t b, std::size_t c) {
    triangles.push_back({corners[a], corners[b], corners[c]});
  };
  const auto fan = [&] {
    for (std::size_t c = 1; c + 1 < corners.size(); ++c) append(0, c, c + 1);
    return true;
  };
  if (corners.size() == 3) return fan();
  const FlatPolygon polygon(vertices, corners);
  if (polygon.is_convex()) return fan();
  if (Ears(polygon).cut(append)) return true;
  triangles.resize(before);
  return false;
}

}  // namespace firn
