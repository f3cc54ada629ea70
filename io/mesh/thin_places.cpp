// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/thin_places.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace firn {

namespace {

/// Halves the triangle across its longest side until no side exceeds `size`, and visits the
/// pieces.
template <class Visit>
void cut(const Vec3& a, const Vec3& b, const Vec3& c, double size, Visit& visit) {
  const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
  const double longest = std::max({ab, bc, ca});
  if (!(longest > size * size)) return visit(a, b, c);
  if (ab < longest) return bc == longest ? cut(b, c, a, size, visit) : cut(c, a, b, size, visit);
  const Vec3 middle = 0.5 * (a + b);
  cut(a, middle, c, size, visit);
  cut(middle, b, c, size, visit);
}

double total_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    area += 0.5 *
            (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm();
  return area;
}

/// How far the edge is in which two faces would meet that are `thickness` apart here, with
/// outward normals n and m; infinite for parallel ones.
double distance_to_edge(double thickness, const Vec3& n, const Vec3& m) {
  const double cosine = -n.dot(m);  // of the angle between the faces
  return 0.5 * thickness * std::sqrt((1 + cosine) / std::max(1 - cosine, 1e-300));
}

}  // namespace

std::vector<ThinPlace> thin_places(const MeshSolid& solid, double h) {
  const TriangleMesh& mesh = solid.surface();
  // A million pieces take a second or two.
  const double size = std::max(h / 4, std::sqrt(total_area(mesh) / 1e6));
  std::vector<ThinPlace> places;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t) {
    const Vec3 n = solid.face_normal(t);
    if (n.isZero(0)) continue;
    const auto look = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      const Vec3 x = (a + b + c) / 3;
      for (const bool wall : {true, false}) {
        const Vec3 d = wall ? Vec3(-n) : n;
        const TriangleTree::Hit hit = solid.tree().first_hit(x, d, h, t);
        if (hit.triangle < 0) continue;
        const Vec3 m = solid.face_normal(hit.triangle);
        if (!(n.dot(m) < 0) || distance_to_edge(hit.distance, n, m) < h) continue;
        const Vec3 middle = x + 0.5 * hit.distance * d;
        if (solid.contains(middle) == wall)
          places.push_back({middle, hit.distance, 0.5 * (b - a).cross(c - a).norm(), wall});
      }
    };
    const auto& [a, b, c] = mesh.triangles[t];
    cut(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], size, look);
  }
  return places;
}

std::optional<ThinPlace> unresolved(const std::vector<ThinPlace>& places, const Shape& shape,
                                    double h) {
  struct Cell {
    double area = 0;
    const ThinPlace* thinnest = nullptr;
  };
  std::map<std::array<double, 4>, Cell> cells;
  const Cell* worst = nullptr;
  for (const ThinPlace& place : places) {
    const double phi = signed_distance(shape, place.middle);
    if (place.wall ? phi < 0 : phi > 0) continue;
    const Vec3 corner = (place.middle / h).array().floor();
    Cell& cell = cells[{corner[0], corner[1], corner[2], place.wall ? 1.0 : 0.0}];
    cell.area += place.area;
    if (cell.thinnest == nullptr || place.thickness < cell.thinnest->thickness)
      cell.thinnest = &place;
    if (worst == nullptr || cell.area > worst->area) worst = &cell;
  }
  if (worst == nullptr || !(worst->area > 2 * (h / 4) * (h / 4))) return std::nullopt;
  return *worst->thinnest;
}

}  // namespace firn
