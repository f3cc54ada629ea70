// SPDX-License-Identifier: BSD-3-Clause
// Vertices that differ by roundoff are one vertex.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/mesh/mesh_shape.hpp"
#include "verification/support/points.hpp"
#include "verification/tests/io/mesh/meshes.hpp"

namespace firn {
namespace {

using fixtures::random_point;

/// The triangles as text, each with corners of its own that are off by up to `noise`.
std::string noisy_stl(const TriangleMesh& mesh, double noise) {
  std::string text = "solid\n";
  std::int64_t corner = 0;
  for (const Triangle& t : mesh.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::int32_t vertex : t) {
      const Vec3 x = random_point(1, corner++, mesh.vertices[vertex], noise);
      text += "vertex " + to_text(x[0]) + " " + to_text(x[1]) + " " + to_text(x[2]) + "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid\n";
}

// Coordinates 0, 1/8, 1/4, … are the borders of any grid of cells whose edge is a power of two, so
// that noise puts the corners of one vertex into several cells.
TEST(Weld, CornersNearerThanFloatRoundoffAreOne) {
  for (const double noise : {1e-18, 1e-12, 3e-8}) {  // times 2√3 below 2⁻²³ = 1.2e-7
    TriangleMesh mesh = icosphere(2);
    for (Vec3& x : mesh.vertices) x *= 0.5;  // size 1
    append_mesh(mesh, box_mesh(Vec3(-0.125, -0.125, 0), Vec3(0.125, 0.25, 0.25)));
    const TemporaryFile file("noisy.stl", noisy_stl(mesh, noise));
    const TriangleMesh read = read_mesh(file.path());
    EXPECT_EQ(read.triangles.size(), mesh.triangles.size()) << noise;
    EXPECT_TRUE(is_closed(read));
  }
}

TEST(Weld, CornersFurtherApartStayTwo) {
  const TemporaryFile file("torn.stl", noisy_stl(icosphere(1), 1e-5));
  EXPECT_THAT(input_error([&] { read_mesh(file.path()); }),
              testing::HasSubstr("triangles at the edge from"));
}

TEST(Weld, HoldsAcrossTheCellsOfAnyGrid) {
  // Pairs `gap` apart in a random direction; tolerance just above and just below.
  TriangleMesh mesh;
  constexpr double gap = 0.01;
  for (int p = 0; p < 2000; ++p) {
    const Vec3 x = random_point(2, p, Vec3::Zero(), 100);
    mesh.vertices.push_back(x);
    mesh.vertices.push_back(x + gap * fixtures::random_direction(3, p));
    mesh.triangles.push_back({2 * p, 2 * p + 1, (2 * p + 2) % 4000});
  }
  TriangleMesh above = mesh, below = mesh;
  weld(above, 1.0001 * gap);
  weld(below, 0.9999 * gap);
  EXPECT_TRUE(above.triangles.empty());  // each used both vertices of a pair
  EXPECT_EQ(below.triangles.size(), 2000u);
}

TEST(Weld, ClosedMeshesKeepTheirFineDetails) {
  // A tetrahedron far smaller than roundoff of the mesh beside it, but closed.
  TriangleMesh mesh = icosphere(1);
  const auto v = static_cast<std::int32_t>(mesh.vertices.size());
  for (const Vec3& x : {Vec3(2, 0, 0), Vec3(2 + 1e-8, 0, 0), Vec3(2, 1e-8, 0), Vec3(2, 0, 1e-8)})
    mesh.vertices.push_back(x);
  for (const Triangle& t : {Triangle{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}})
    mesh.triangles.push_back({v + t[0], v + t[1], v + t[2]});
  const TemporaryFile file("detail.obj", obj_text(mesh));
  EXPECT_EQ(read_mesh(file.path()).triangles.size(), 84u);
}

}  // namespace
}  // namespace firn
