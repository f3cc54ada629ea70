// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/triangle_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>
#include <utility>

#include "firn/error.hpp"

namespace firn {

namespace {

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

std::string point_text(const Vec3& x) {
  std::string text(1, '(');  // g++ 12 warns wrongly about `"(" + string`, PR105651
  text += to_text(x[0]) + ", " + to_text(x[1]) + ", " + to_text(x[2]) + ")";
  return text;
}

bool is_closed(const TriangleMesh& mesh) {
  const std::vector<Edge> edges = sorted_edges(mesh);
  for (std::size_t e = 0; e < edges.size(); e += 2)
    if (e + 1 == edges.size() || !edges[e].same_place(edges[e + 1]) ||
        (e > 0 && edges[e].same_place(edges[e - 1])))
      return false;
  return !edges.empty();
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

bool turn_alike(TriangleMesh& shell) {
  struct Neighbour {
    std::int32_t triangle;
    bool alike;  // as the two turn in the file
  };
  const auto runs_up = [&](std::int32_t t, const Edge& edge) {  // from low to high
    const Triangle& c = shell.triangles[t];
    for (int corner = 0; corner < 3; ++corner)
      if (c[corner] == edge.low) return c[(corner + 1) % 3] == edge.high;
    return false;
  };
  std::vector<std::array<Neighbour, 3>> neighbours(shell.triangles.size());
  std::vector<int> known(shell.triangles.size(), 0);
  const std::vector<Edge> edges = sorted_edges(shell);
  for (std::size_t e = 0; e + 1 < edges.size(); e += 2) {
    const std::int32_t a = edges[e].triangle, b = edges[e + 1].triangle;
    const bool alike = runs_up(a, edges[e]) != runs_up(b, edges[e]);
    neighbours[a][known[a]++] = {b, alike};
    neighbours[b][known[b]++] = {a, alike};
  }

  std::vector<signed char> turn(shell.triangles.size(), 0);  // +1 as it is, −1 reversed
  std::vector<std::int32_t> front = {0};
  turn[0] = 1;
  std::size_t kept = 0;
  for (std::size_t next = 0; next < front.size(); ++next) {
    const std::int32_t t = front[next];
    kept += turn[t] > 0;
    for (const Neighbour& n : neighbours[t]) {
      const auto wanted = static_cast<signed char>(n.alike ? turn[t] : -turn[t]);
      if (turn[n.triangle] == 0) {
        turn[n.triangle] = wanted;
        front.push_back(n.triangle);
      } else if (turn[n.triangle] != wanted) {
        return false;
      }
    }
  }
  const signed char reversed = 2 * kept >= shell.triangles.size() ? -1 : 1;
  for (std::size_t t = 0; t < turn.size(); ++t)
    if (turn[t] == reversed) std::swap(shell.triangles[t][1], shell.triangles[t][2]);
  return true;
}

void turn_over(TriangleMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
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
