// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/winding.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace firn {

namespace {

__extension__ using Wide = __int128;  // holds products of differences of 54 bits

using Place = std::array<std::int64_t, 2>;  // x and y in units of the quantum

/// +1 if p lies left of the line from a to b, −1 if right of it. A point on the line is
/// moved by (ε, ε²); 0 only if a = b.
int side(const Place& a, const Place& b, const Place& p) {
  const std::int64_t dx = b[0] - a[0], dy = b[1] - a[1];
  const Wide area = Wide(dx) * (p[1] - a[1]) - Wide(dy) * (p[0] - a[0]);
  if (area != 0) return area > 0 ? 1 : -1;
  if (dy != 0) return dy < 0 ? 1 : -1;
  return dx > 0 ? 1 : dx < 0 ? -1 : 0;
}

}  // namespace

WindingNumbers::WindingNumbers(const std::vector<TriangleMesh>& parts) {
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const auto first = static_cast<std::int32_t>(surface_.vertices.size());
    surface_.vertices.insert(surface_.vertices.end(), parts[part].vertices.begin(),
                             parts[part].vertices.end());
    for (const auto& [a, b, c] : parts[part].triangles) {
      surface_.triangles.push_back({first + a, first + b, first + c});
      part_of_.push_back(static_cast<std::int32_t>(part));
    }
  }
  double largest = 0;
  for (const Vec3& x : surface_.vertices) largest = std::max(largest, x.cwiseAbs().maxCoeff());
  if (largest > 0) quantum_ = std::ldexp(1.0, std::max(std::ilogb(largest) - 52, -1000));
  for (Vec3& x : surface_.vertices) x = rounded(x);
  bounds_ = firn::bounds(surface_);
  tree_.emplace(surface_);
}

Vec3 WindingNumbers::rounded(const Vec3& x) const {
  Vec3 multiple;
  for (int axis = 0; axis < 3; ++axis)
    multiple[axis] = quantum_ * std::nearbyint(x[axis] / quantum_);
  return multiple;
}

/// What the triangle adds to the winding number around x.
int WindingNumbers::crossing(std::int32_t triangle, const Vec3& x) const {
  std::array<const Vec3*, 3> corner;
  std::array<Place, 3> place;
  const auto in_quanta = [&](const Vec3& v) {
    return Place{static_cast<std::int64_t>(v[0] / quantum_),
                 static_cast<std::int64_t>(v[1] / quantum_)};
  };
  for (int c = 0; c < 3; ++c) {
    corner[c] = &surface_.vertices[surface_.triangles[triangle][c]];
    place[c] = in_quanta(*corner[c]);
  }
  const Place p = in_quanta(x);
  const int turn = side(place[0], place[1], p);
  if (turn == 0 || side(place[1], place[2], p) != turn || side(place[2], place[0], p) != turn)
    return 0;
  const Vec3 ab = *corner[1] - *corner[0], ac = *corner[2] - *corner[0];
  return turn * (*corner[0] - x).dot(ab.cross(ac)) > 0 ? turn : 0;
}

void WindingNumbers::find(const Vec3& x, std::vector<Around>& around) const {
  around.clear();
  const Vec3 p = rounded(x);
  if (!((p.array() >= bounds_.min.array()).all() && (p.array() <= bounds_.max.array()).all()))
    return;
  tree_->for_each_above(p, [&](std::int32_t triangle) {
    const int winding = crossing(triangle, p);
    if (winding == 0) return;
    const std::int32_t part = part_of_[triangle];
    const auto known =
        std::find_if(around.begin(), around.end(), [&](const Around& a) { return a.part == part; });
    if (known == around.end())
      around.push_back({part, winding});
    else
      known->winding += winding;
  });
  std::erase_if(around, [](const Around& a) { return a.winding == 0; });
}

}  // namespace firn
