// SPDX-License-Identifier: BSD-3-Clause
// Exact distances to triangles, against closed forms and brute force.

#include <gtest/gtest.h>
#include <limits>

#include "io/mesh/triangle_tree.hpp"
#include "verification/support/points.hpp"
#include "verification/tests/io/mesh/meshes.hpp"

namespace firn {
namespace {

using fixtures::random_point;

constexpr double eps = std::numeric_limits<double>::epsilon();

TEST(TriangleDistance, PencilCases) {
  const Vec3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  EXPECT_EQ(distance_squared(Vec3(1, 1, 3), a, b, c), 9);      // above the inside
  EXPECT_EQ(distance_squared(Vec3(1, 1, 0), a, b, c), 0);      // in it
  EXPECT_EQ(distance_squared(Vec3(2, -3, 0), a, b, c), 9);     // beside an edge
  EXPECT_EQ(distance_squared(Vec3(4, 4, 1), a, b, c), 8 + 1);  // beside the long edge
  EXPECT_EQ(distance_squared(Vec3(-1, -2, 2), a, b, c), 9);    // beyond a corner
  EXPECT_EQ(distance_squared(Vec3(7, -4, 0), a, b, c), 25);
}

TEST(TriangleDistance, DegenerateTrianglesAreSegmentsAndPoints) {
  const Vec3 a(0, 0, 0), b(4, 0, 0);
  EXPECT_EQ(distance_squared(Vec3(1, 2, 0), a, b, Vec3(2, 0, 0)), 4);
  EXPECT_EQ(distance_squared(Vec3(1, 2, 2), a, a, a), 9);
  EXPECT_EQ(distance_squared(Vec3(6, 0, 0), a, a, b), 4);
}

TEST(TriangleDistance, IsThatToTheNearestOfManyPointsOfTheTriangle) {
  for (int p = 0; p < 200; ++p) {
    const Vec3 a = random_point(1, 4 * p, Vec3::Zero(), 1),
               b = random_point(1, 4 * p + 1, Vec3::Zero(), 1);
    const Vec3 c = random_point(1, 4 * p + 2, Vec3::Zero(), 1),
               x = random_point(1, 4 * p + 3, Vec3::Zero(), 2);
    double nearest = 1e9;
    constexpr int n = 50;
    for (int u = 0; u <= n; ++u)
      for (int v = 0; u + v <= n; ++v)
        nearest =
            std::min(nearest, (a + double(u) / n * (b - a) + double(v) / n * (c - a) - x).norm());
    const double d = std::sqrt(distance_squared(x, a, b, c));
    EXPECT_LE(d, nearest + 8 * eps);
    EXPECT_GE(d, nearest - 2 * 3.5 / n);  // two sides of at most 3.5, a step of 1/n on each
  }
}

TEST(TriangleTree, FindsTheNearestTriangle) {
  const TriangleMesh mesh = icosphere(3);
  const TriangleTree tree(mesh);
  for (int p = 0; p < 300; ++p) {
    const Vec3 x = random_point(2, p, Vec3::Zero(), 2);
    double nearest = 1e9;
    for (const auto& [a, b, c] : mesh.triangles)
      nearest = std::min(nearest,
                         distance_squared(x, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]));
    std::int32_t found = -1;
    EXPECT_EQ(tree.distance(x, found), std::sqrt(nearest));
    const auto& [a, b, c] = mesh.triangles.at(found);
    EXPECT_EQ(distance_squared(x, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]), nearest);
    std::int32_t bad_guess = p;
    EXPECT_EQ(tree.distance(x, bad_guess), std::sqrt(nearest));
  }
}

TEST(TriangleTree, OfNoTrianglesIsInfinitelyFar) {
  const TriangleMesh none;
  std::int32_t nearest = -1;
  EXPECT_EQ(TriangleTree(none).distance(Vec3::Zero(), nearest),
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace firn
