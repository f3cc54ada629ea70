// SPDX-License-Identifier: BSD-3-Clause
// The exact inside of meshes, against closed forms and enclosed volumes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

#include "firn/scene.hpp"
#include "io/mesh/mesh_shape.hpp"
#include "io/mesh/mesh_solid.hpp"
#include "verification/support/points.hpp"
#include "verification/tests/io/mesh/meshes.hpp"

namespace firn {
namespace {

using fixtures::random_point;

/// Share of random points in the bounds that lie in the solid, as a volume, and its standard
/// deviation.
std::pair<double, double> measured_volume(const MeshSolid& solid, int points) {
  const Vec3 middle = 0.5 * (solid.bounds().min + solid.bounds().max);
  const double half = (solid.bounds().max - middle).maxCoeff();
  int inside = 0;
  for (int p = 0; p < points; ++p) inside += solid.contains(random_point(1, p, middle, half));
  const double cube = std::pow(2 * half, 3), share = static_cast<double>(inside) / points;
  return {share * cube, cube * std::sqrt(share * (1 - share) / points)};
}

TriangleMesh ring() {
  std::vector<std::pair<double, double>> circle;
  for (int i = 0; i < 20; ++i) {
    const double angle = 2 * std::numbers::pi * i / 20;
    circle.emplace_back(0.4 + 0.02 * std::cos(angle), 0.02 * std::sin(angle));
  }
  return revolved(circle, 48);
}

/// A flask with walls 0.02 thick and a mouth 0.04 wide.
TriangleMesh bottle() {
  return revolved({{0, 0},
                   {0.3, 0},
                   {0.3, 0.5},
                   {0.04, 0.6},
                   {0.04, 0.8},
                   {0.02, 0.8},
                   {0.02, 0.59},
                   {0.28, 0.48},
                   {0.28, 0.02},
                   {0, 0.02}},
                  40);
}

TEST(MeshSolid, HoldsTheEnclosedVolumeOfThinAndOfNarrowMeshes) {
  for (const TriangleMesh& mesh : {ring(), bottle(), box_mesh(Vec3(0, 0, 0), Vec3(1, 1, 1e-3))}) {
    const MeshSolid solid(mesh, "mesh");
    const auto [volume, deviation] = measured_volume(solid, 200000);
    EXPECT_NEAR(volume, std::abs(signed_volume(mesh)), 4 * deviation);
    EXPECT_NEAR(*solid.volume(), volume, 4 * deviation);
  }
}

TEST(MeshSolid, ABottleIsEmpty) {
  const MeshSolid solid(bottle(), "bottle");
  EXPECT_FALSE(solid.contains(Vec3(0, 0, 0.3)));
  EXPECT_FALSE(solid.contains(Vec3(0.01, 0, 0.7)));     // in the neck
  EXPECT_TRUE(solid.contains(Vec3(0.03, 0, 0.7)));      // its wall
  EXPECT_TRUE(solid.contains(Vec3(0.01, 0.02, 0.01)));  // the bottom
  EXPECT_FALSE(solid.contains(Vec3(0.01, 0.02, -0.01)));
}

// Bodies are sampled without distances in between: jittered points, one in each of 64 parts of a
// cell, hit every part of the solid alike.
TEST(MeshSolid, BodiesFillTheEnclosedVolumeAtAnySpacing) {
  const TemporaryFile file("ring.obj", obj_text(ring()));
  for (const double h : {0.05, 0.1}) {
    Scene scene;
    scene.grid.spacing = h;
    scene.materials.resize(1);
    Body body;
    body.shape = load_mesh_solid(file.path(), 1, Vec3::Zero());
    body.sampling = Sampling::jittered;
    body.particles_per_cell = 1000;
    scene.bodies = {body};
    const auto count = static_cast<double>(sample_bodies(scene).size());
    const double enclosed = std::abs(signed_volume(ring()));
    // Each count is 0 or 1: the variance is at most the count.
    EXPECT_NEAR(count * h * h * h / 1000, enclosed, 4 * enclosed / std::sqrt(count)) << h;
  }
}

TEST(MeshSolid, FacesAlongTheAxesBelongToTheSolidAtMinOnly) {
  const Box box{Vec3(-0.5, 0, 0.25), Vec3(0.5, 0.75, 1)};
  for (const bool inside_out : {false, true}) {
    TriangleMesh mesh = box_mesh(box.min, box.max);
    if (inside_out) turn_over(mesh);
    const MeshSolid solid(mesh, "box");
    // Points in, on and beyond the faces, also on the diagonals that cut them, on edges and
    // corners.
    for (int i = -3; i <= 3; ++i)
      for (int j = -1; j <= 4; ++j)
        for (int k = 0; k <= 5; ++k) {
          const Vec3 x = 0.25 * Vec3(i, j, k);
          EXPECT_EQ(solid.contains(x), contains(box, x)) << x.transpose();
        }
  }
}

TEST(MeshSolid, LinesThroughVerticesAndEdgesCountOnce) {
  const TriangleMesh ball = icosphere(3);
  const MeshSolid solid(ball, "ball");
  int inside = 0, tested = 0;
  for (const auto& [a, b, c] : ball.triangles)
    for (const Vec3& x : {ball.vertices[a], Vec3(0.5 * (ball.vertices[a] + ball.vertices[b]))})
      for (const double z : {-1.5, -0.7, -0.3, 0.0, 0.2, 0.6, 1.5}) {
        const Vec3 p(x[0], x[1], z);
        if (std::abs(p.norm() - 1) < 0.01) continue;  // facets
        EXPECT_EQ(solid.contains(p), p.norm() < 1);
        inside += solid.contains(p);
        ++tested;
      }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(tested, 2 * inside);
}

TEST(MeshSolid, DistancesAndNormalsAreThoseOfTheSurface) {
  const Box box{Vec3(0, 0, 0), Vec3(1, 2, 3)};
  const MeshSolid solid(box_mesh(box.min, box.max), "box");
  for (int p = 0; p < 500; ++p) {
    const Vec3 x = random_point(2, p, Vec3(0.5, 1, 1.5), 2);
    EXPECT_NEAR(solid.distance(x), signed_distance(box, x), 1e-14);
    EXPECT_LT((solid.normal(x) - outward_normal(box, x)).norm(), 1e-12);
  }
  EXPECT_EQ(solid.normal(Vec3(0.5, 1, 3)), Vec3::UnitZ());  // on a face
}

/// Two balls side by side and one more with a hollow, each turned one way or the other.
TEST(MeshSolid, ShellsThatLieInNoOtherAreSolidHoweverTheyTurn) {
  for (int turns = 0; turns < 16; ++turns) {
    TriangleMesh mesh;
    const Vec3 middle[] = {Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(0, 4, 0), Vec3(0, 4, 0)};
    const double radius[] = {1, 0.5, 1.5, 0.6};
    for (int b = 0; b < 4; ++b) {
      TriangleMesh ball = icosphere(2);
      for (Vec3& x : ball.vertices) x = radius[b] * x + middle[b];
      // The hollow turns against the ball around it.
      if ((turns >> std::min(b, 2) & 1) != (b == 3)) turn_over(ball);
      if (turns & 8) std::swap(ball.triangles[5][0], ball.triangles[5][1]);  // one astray
      append_mesh(mesh, ball);
    }
    const MeshSolid solid(mesh, "balls");
    EXPECT_TRUE(solid.contains(middle[0]));
    EXPECT_TRUE(solid.contains(middle[1]));
    EXPECT_FALSE(solid.contains(middle[2]));
    EXPECT_TRUE(solid.contains(middle[2] + Vec3(1, 0, 0)));
    EXPECT_FALSE(solid.contains(Vec3(1.5, 1.5, 0)));
    EXPECT_EQ(solid.shells()[3].hollow, true);
  }
}

TEST(MeshSolid, ShellsThatOverlapAreOneSolidOfUnknownVolume) {
  TriangleMesh mesh = box_mesh(Vec3(0, 0, 0), Vec3(2, 1, 1));
  TriangleMesh other = box_mesh(Vec3(1, 0.25, 0.25), Vec3(3, 0.75, 0.75));
  turn_over(other);
  append_mesh(mesh, other);
  const MeshSolid solid(mesh, "boxes");
  for (const double x : {0.5, 1.5, 2.5}) EXPECT_TRUE(solid.contains(Vec3(x, 0.5, 0.5)));
  EXPECT_FALSE(solid.volume());
}

TEST(MeshSolid, RefusesSurfacesOfOneSide) {
  // A Klein bottle: a grid of 6 × 6 joined straight along one side and mirrored along the other.
  TriangleMesh mesh;
  constexpr int n = 6;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      mesh.vertices.push_back(random_point(3, n * i + j, Vec3::Zero(), 1));
  const auto at = [&](int i, int j) { return i < n ? n * i + j % n : (n - j % n) % n; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  require_closed(mesh, "klein.obj");
  EXPECT_THAT(input_error([&] { MeshSolid(mesh, "klein.obj"); }),
              testing::HasSubstr("klein.obj: surface: got one with a single side"));
}

}  // namespace
}  // namespace firn
