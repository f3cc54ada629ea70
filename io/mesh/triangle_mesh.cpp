// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/triangle_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "firn/error.hpp"

namespace firn {

namespace {

auto coordinates(const Vec3& x) { return std::make_tuple(x[0], x[1], x[2]); }

std::string point_text(const Vec3& x) {
  return "(" + to_text(x[0]) + ", " + to_text(x[1]) + ", " + to_text(x[2]) + ")";
}

struct Edge {
  std::int32_t low, high;  // vertices
  std::int32_t triangle;

  bool same_place(const Edge& other) const { return low == other.low && high == other.high; }
};

/// Every edge of every triangle, those between the same vertices side by side.
std::vector<Edge> sorted_edges(const TriangleMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int corner = 0; corner < 3; ++corner) {
      const std::int32_t a = mesh.triangles[t][corner], b = mesh.triangles[t][(corner + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t)});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return edges;
}

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
  std::erase_if(mesh.triangles,
                [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

void require_closed(const TriangleMesh& mesh, const std::string& where) {
  if (mesh.triangles.empty())
    throw InputError(where, "triangles", "0", "a closed surface of at least 4");
  const std::vector<Edge> edges = sorted_edges(mesh);
  for (auto edge = edges.begin(); edge != edges.end();) {
    const auto next =
        std::find_if(edge, edges.end(), [&](const Edge& e) { return !e.same_place(*edge); });
    if (next - edge != 2)
      throw InputError(where,
                       "triangles at the edge from " + point_text(mesh.vertices[edge->low]) +
                           " to " + point_text(mesh.vertices[edge->high]),
                       std::to_string(next - edge), "2, as on every edge of a closed surface");
    edge = next;
  }
}

std::vector<TriangleMesh> shells(const TriangleMesh& mesh) {
  // Union-find over the triangles; every group is known by its first triangle.
  std::vector<std::int32_t> parent(mesh.triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  const std::vector<Edge> edges = sorted_edges(mesh);
  for (std::size_t e = 1; e < edges.size(); ++e)
    if (edges[e].same_place(edges[e - 1])) {
      const std::int32_t a = root(edges[e].triangle), b = root(edges[e - 1].triangle);
      parent[std::max(a, b)] = std::min(a, b);
    }

  std::vector<TriangleMesh> parts;
  std::vector<std::int32_t> part_of(mesh.triangles.size(), -1);
  std::vector<std::pair<std::int32_t, std::int32_t>> copied(mesh.vertices.size(), {-1, -1});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::int32_t group = root(static_cast<std::int32_t>(t));
    if (part_of[group] < 0) {
      part_of[group] = static_cast<std::int32_t>(parts.size());
      parts.emplace_back();
    }
    part_of[t] = part_of[group];
  }
  // A vertex may belong to two parts that touch there: copied once for each.
  std::vector<std::vector<std::int32_t>> triangles(parts.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    triangles[part_of[t]].push_back(static_cast<std::int32_t>(t));
  for (std::int32_t part = 0; part < static_cast<std::int32_t>(parts.size()); ++part)
    for (const std::int32_t t : triangles[part]) {
      Triangle corners = mesh.triangles[t];
      for (std::int32_t& corner : corners) {
        auto& [owner, index] = copied[corner];
        if (owner != part) {
          owner = part;
          index = static_cast<std::int32_t>(parts[part].vertices.size());
          parts[part].vertices.push_back(mesh.vertices[corner]);
        }
        corner = index;
      }
      parts[part].triangles.push_back(corners);
    }
  return parts;
}

double signed_volume(const TriangleMesh& mesh) {
  double sixfold = 0;
  const Vec3& origin = mesh.vertices.front();  // on the mesh: no cancellation far from zero
  for (const auto& [a, b, c] : mesh.triangles)
    sixfold += (mesh.vertices[a] - origin)
                   .dot((mesh.vertices[b] - origin).cross(mesh.vertices[c] - origin));
  return sixfold / 6;
}

Bounds bounds(const TriangleMesh& mesh) {
  Bounds b{mesh.vertices.front(), mesh.vertices.front()};
  for (const Vec3& x : mesh.vertices) {
    b.min = b.min.cwiseMin(x);
    b.max = b.max.cwiseMax(x);
  }
  return b;
}

}  // namespace firn
