// SPDX-License-Identifier: BSD-3-Clause
// Polygons cut into triangles: nothing but the polygon is covered, and every point of it once.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numeric>

#include "io/mesh/parse_obj.hpp"
#include "io/mesh/polygon.hpp"
#include "verification/support/points.hpp"
#include "verification/tests/io/mesh/meshes.hpp"

namespace firn {
namespace {

using testing::HasSubstr;

std::vector<std::int32_t> all(const std::vector<Vec3>& vertices) {
  std::vector<std::int32_t> corners(vertices.size());
  std::iota(corners.begin(), corners.end(), 0);
  return corners;
}

/// The sum of the triangles' areas, each of which must turn as `normal` says.
double area(const std::vector<Vec3>& v, const std::vector<Triangle>& triangles,
            const Vec3& normal) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const double twice = (v[b] - v[a]).cross(v[c] - v[a]).dot(normal);
    EXPECT_GE(twice, -1e-15);
    sum += twice / 2;
  }
  return sum;
}

TEST(Polygon, ConvexOnesAreFansFromTheirFirstCorner) {
  const std::vector<Vec3> v = {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(3, 1, 0), Vec3(3, 2, 0),
                               Vec3(1, 2, 0)};
  std::vector<Triangle> triangles;
  ASSERT_TRUE(append_polygon(v, {1, 2, 3, 4, 0}, triangles));
  EXPECT_EQ(triangles, (std::vector<Triangle>{{1, 2, 3}, {1, 3, 4}, {1, 4, 0}}));
}

TEST(Polygon, FansIncludeCornersOnALine) {
  const std::vector<Vec3> v = {Vec3(0, 0, 0),     Vec3(0.1, 0, 0),   Vec3(0.3, 0, 0),
                               Vec3(0.3, 0.7, 0), Vec3(0.3, 0.9, 0), Vec3(0, 0.9, 0)};
  std::vector<Triangle> triangles;
  ASSERT_TRUE(append_polygon(v, all(v), triangles));
  EXPECT_EQ(triangles.front(), (Triangle{0, 1, 2}));
  EXPECT_EQ(triangles.size(), 4u);
}

TEST(Polygon, ConcaveOnesLoseEars) {
  // A star of n points, turned anywhere in space; its first corner is a hollow one.
  for (int n = 3; n <= 12; ++n) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), fixtures::random_direction(1, n));
    std::vector<Vec3> v;
    for (int i = 0; i < 2 * n; ++i) {
      const double r = i % 2 == 0 ? 0.3 : 1, angle = 3.14159265358979 * i / n;
      v.push_back(turn * Vec3(r * std::cos(angle), r * std::sin(angle), 0) + Vec3(1, 2, 3));
    }
    std::vector<Triangle> triangles;
    ASSERT_TRUE(append_polygon(v, all(v), triangles));
    EXPECT_EQ(triangles.size(), 2u * n - 2);
    EXPECT_NEAR(area(v, triangles, turn * Vec3::UnitZ()), n * 0.3 * std::sin(3.14159265358979 / n),
                1e-14 * n);
  }
}

TEST(Polygon, CombsAndSpirals) {
  std::vector<Vec3> comb;  // 50 teeth, 1 wide and 2 high, on a bar of height 1
  for (int i = 0; i < 50; ++i)
    for (const Vec3& x :
         {Vec3(2 * i, 3, 0), Vec3(2 * i + 1, 3, 0), Vec3(2 * i + 1, 1, 0), Vec3(2 * i + 2, 1, 0)})
      comb.push_back(x);
  comb.emplace_back(100, 0, 0);
  comb.emplace_back(0, 0, 0);
  std::vector<Triangle> triangles;
  ASSERT_TRUE(append_polygon(comb, all(comb), triangles));
  EXPECT_NEAR(area(comb, triangles, -Vec3::UnitZ()), 100 + 50 * 2, 1e-10);

  std::vector<Vec3> spiral;  // out along one side, back along the other
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i <= 60; ++i) {
      const int at = side == 0 ? i : 60 - i;
      const double r = 1 + 0.1 * at + 0.2 * side;
      spiral.emplace_back(r * std::cos(0.3 * at), r * std::sin(0.3 * at), 0);
    }
  triangles.clear();
  ASSERT_TRUE(append_polygon(spiral, all(spiral), triangles));
  double expected = 0;
  for (std::size_t i = 0; i < spiral.size(); ++i)
    expected += spiral[i].cross(spiral[(i + 1) % spiral.size()])[2] / 2;
  EXPECT_NEAR(area(spiral, triangles, (expected > 0 ? 1 : -1) * Vec3::UnitZ()), std::abs(expected),
              1e-10);
}

TEST(Polygon, BridgesJoinHoles) {
  // A square of side 4 with two holes of side 1, each joined to the square's first corner.
  const std::vector<Vec3> v = {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(4, 4, 0),   Vec3(0, 4, 0),
                               Vec3(1, 1, 0), Vec3(1, 2, 0), Vec3(2, 2, 0),   Vec3(2, 1, 0),
                               Vec3(1, 3, 0), Vec3(2, 3, 0), Vec3(2, 2.5, 0), Vec3(1, 2.5, 0)};
  std::vector<Triangle> triangles;
  ASSERT_TRUE(append_polygon(v, {0, 1, 2, 3, 0, 11, 8, 9, 10, 11, 0, 4, 5, 6, 7, 4}, triangles));
  EXPECT_NEAR(area(v, triangles, Vec3::UnitZ()), 16 - 1 - 0.5, 1e-14);
}

TEST(Polygon, RefusesOnesThatCrossThemselves) {
  const std::vector<Vec3> v = {Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(0, 1, 0), Vec3(2, 1.5, 0)};
  std::vector<Triangle> triangles;
  EXPECT_FALSE(append_polygon(v, {0, 1, 2, 3}, triangles));
  EXPECT_TRUE(triangles.empty());
  EXPECT_THAT(input_error([] {
                parse_obj("v 0 0 0\nv 3 0 0\nv 0 1 0\nv 2 1.5 0\nf 1 2 3 4\n", "bow.obj");
              }),
              HasSubstr("bow.obj:5: face: got a polygon of 4 corners that crosses itself"));
}

TEST(Polygon, AWallWithAWindowIsClosed) {
  const TriangleMesh wall = parse_obj(
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.3 0.3 0\nv 0.3 0.7 0\nv 0.7 0.7 0\nv 0.7 0.3 0\n"
      "v 0 0 0.2\nv 1 0 0.2\nv 1 1 0.2\nv 0 1 0.2\nv 0.3 0.3 0.2\nv 0.3 0.7 0.2\n"
      "v 0.7 0.7 0.2\nv 0.7 0.3 0.2\nf 1 5 8 7 6 5 1 4 3 2\nf 10 11 12 9 13 14 15 16 13 9\n"
      "f 1 2 10 9\nf 2 3 11 10\nf 3 4 12 11\nf 4 1 9 12\nf 5 6 14 13\nf 6 7 15 14\n"
      "f 7 8 16 15\nf 8 5 13 16\n");
  EXPECT_NO_THROW(require_closed(wall, "wall"));
  EXPECT_NEAR(std::abs(signed_volume(wall)), 0.2 * (1 - 0.4 * 0.4), 1e-15);
}

TEST(Polygon, AChannelIsOpen) {
  const TriangleMesh channel = parse_obj(
      "v 0 0 0\nv 1.5 0 0\nv 1.5 0 1\nv 1 0 1\nv 1 0 0.5\nv 0.5 0 0.5\nv 0.5 0 1\nv 0 0 1\n"
      "v 0 1 0\nv 1.5 1 0\nv 1.5 1 1\nv 1 1 1\nv 1 1 0.5\nv 0.5 1 0.5\nv 0.5 1 1\nv 0 1 1\n"
      "f 1 2 3 4 5 6 7 8\nf 16 15 14 13 12 11 10 9\nf 1 9 10 2\nf 2 10 11 3\nf 3 11 12 4\n"
      "f 4 12 13 5\nf 5 13 14 6\nf 6 14 15 7\nf 7 15 16 8\nf 8 16 9 1\n");
  EXPECT_NO_THROW(require_closed(channel, "channel"));
  double end_faces = 0;
  for (const auto& [a, b, c] : channel.triangles) {
    const Vec3 normal = (channel.vertices[b] - channel.vertices[a])
                            .cross(channel.vertices[c] - channel.vertices[a]);
    if (normal[1] != 0) end_faces += normal.norm() / 2;
  }
  EXPECT_NEAR(end_faces, 2 * (1.5 * 0.5 + 2 * 0.5 * 0.5), 1e-15);
}

}  // namespace
}  // namespace firn
