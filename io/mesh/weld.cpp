// SPDX-License-Identifier: BSD-3-Clause
// Vertices of one place become one vertex.

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "io/mesh/triangle_mesh.hpp"

namespace firn {

namespace {

auto coordinates(const Vec3& x) { return std::make_tuple(x[0], x[1], x[2]); }

void drop_degenerate(TriangleMesh& mesh) {
  std::erase_if(mesh.triangles,
                [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

/// Cells of a grid with the vertices in them, to look up neighbours.
class Cells {
 public:
  Cells(const std::vector<Vec3>& vertices, double edge) : edge_(edge) {
    for (std::size_t v = 0; v < vertices.size(); ++v)
      entries_.push_back({cell_of(vertices[v]), static_cast<std::int32_t>(v)});
    std::sort(entries_.begin(), entries_.end());
  }

  /// Visits the vertices in the cell of x and in the 26 cells around it.
  template <class Visit>
  void for_each_near(const Vec3& x, Visit visit) const {
    const Cell here = cell_of(x);
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {  // the three cells along z stand together
        const Entry low{{here[0] + i, here[1] + j, here[2] - 1}, 0};
        for (auto entry = std::lower_bound(entries_.begin(), entries_.end(), low);
             entry != entries_.end() && entry->first[0] == low.first[0] &&
             entry->first[1] == low.first[1] && entry->first[2] <= here[2] + 1;
             ++entry)
          visit(entry->second);
      }
  }

 private:
  using Cell = std::array<double, 3>;  // whole numbers
  using Entry = std::pair<Cell, std::int32_t>;

  Cell cell_of(const Vec3& x) const {
    return {std::floor(x[0] / edge_), std::floor(x[1] / edge_), std::floor(x[2] / edge_)};
  }

  double edge_;
  std::vector<Entry> entries_;
};

}  // namespace

void weld(TriangleMesh& mesh) {
  std::vector<std::int32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return coordinates(mesh.vertices[a]) < coordinates(mesh.vertices[b]);
  });
  std::vector<std::int32_t> welded(order.size());
  std::vector<Vec3> vertices;
  for (const std::int32_t vertex : order) {
    if (vertices.empty() || vertices.back() != mesh.vertices[vertex])
      vertices.push_back(mesh.vertices[vertex]);
    welded[vertex] = static_cast<std::int32_t>(vertices.size()) - 1;
  }
  mesh.vertices = std::move(vertices);
  for (Triangle& t : mesh.triangles)
    for (std::int32_t& corner : t) corner = welded[corner];
  drop_degenerate(mesh);
}

void weld(TriangleMesh& mesh, double tolerance) {
  if (mesh.vertices.empty() || !(tolerance > 0)) return;
  const Cells cells(mesh.vertices, tolerance);
  std::vector<std::int32_t> one(mesh.vertices.size(), -1);  // the vertex that takes its place
  std::vector<std::int32_t> front;
  for (std::int32_t first = 0; first < static_cast<std::int32_t>(one.size()); ++first) {
    if (one[first] >= 0) continue;
    one[first] = first;
    front = {first};
    while (!front.empty()) {
      const Vec3 x = mesh.vertices[front.back()];
      front.pop_back();
      cells.for_each_near(x, [&](std::int32_t other) {
        if (one[other] >= 0 || !((mesh.vertices[other] - x).norm() <= tolerance)) return;
        one[other] = first;
        front.push_back(other);
      });
    }
  }
  for (Triangle& t : mesh.triangles)
    for (std::int32_t& corner : t) corner = one[corner];
  drop_degenerate(mesh);
}

}  // namespace firn
