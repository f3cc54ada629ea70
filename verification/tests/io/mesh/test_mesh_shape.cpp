// SPDX-License-Identifier: BSD-3-Clause
// Meshes and level sets as shapes, against the analytic shapes that they stand for.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

#include "firn/collider.hpp"
#include "firn/sampled_distance.hpp"
#include "firn/scene.hpp"
#include "io/mesh/mesh_shape.hpp"
#include "verification/support/points.hpp"
#include "verification/tests/io/mesh/meshes.hpp"

namespace firn {
namespace {

using fixtures::random_direction;
using fixtures::random_point;

using testing::HasSubstr;

const SampledDistance& sampled(const Shape& shape) {
  return *std::get<SampledShape>(shape).distance;
}

class MeshShape : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_openvdb()) GTEST_SKIP() << "built without OpenVDB";
  }
};

// A ball of radius 0.3 at h = 0.05, as in the built-in scenes.
constexpr double radius = 0.3, h = 0.05;
constexpr int level = 4;  // 5120 triangles

Shape mesh_ball() {
  const TemporaryFile file("ball.obj", obj_text(icosphere(level)));
  return load_mesh_shape(file.path(), radius, Vec3(1, 2, 3), h);
}

// The surface lies within the ball, by up to e²/(6R) at the middle of a triangle
// of side e (circumradius e/√3); an icosahedron's sides of 1.05 R, halved four
// times, stretch to at most 0.08 R.
constexpr double facets = 0.08 * 0.08 / 6 * radius;

// Trilinear interpolation of ‖x‖ errs by at most s²/(4r) (two directions of
// curvature 1/r, s²/8 each); here s = h/2.
double interpolation(double r) { return h * h / 4 / (4 * r); }

TEST_F(MeshShape, BallHasTheDistancesOfASphere) {
  const Shape ball = mesh_ball();
  const Shape sphere = Sphere{Vec3(1, 2, 3), radius};
  int inside = 0, beyond = 0;
  for (int p = 0; p < 4000; ++p) {
    const Vec3 x = random_point(1, p, Vec3(1, 2, 3), 0.6);
    const double r = (x - Vec3(1, 2, 3)).norm();
    if (!((x - sampled(ball).box().min).minCoeff() > 0 &&
          (sampled(ball).box().max - x).minCoeff() > 0)) {
      ++beyond;  // there the distance is a lower bound
      EXPECT_LE(signed_distance(ball, x), r - radius + facets + interpolation(radius));
      continue;
    }
    if (r < h) continue;  // the kink at the centre: below
    EXPECT_NEAR(signed_distance(ball, x), r - radius, facets + interpolation(r - h / 2)) << r;
    inside += r < radius;
  }
  EXPECT_GT(inside, 150);
  EXPECT_GT(beyond, 20);
  EXPECT_NEAR(signed_distance(ball, Vec3(1, 2, 3)), -radius, h / 2 + facets);
}

TEST_F(MeshShape, BallHasTheNormalsOfASphere) {
  const Shape ball = mesh_ball();
  for (int p = 0; p < 1000; ++p) {
    const double r = radius * (0.5 + 0.6 * uniform(2, {p}));
    const Vec3 n = random_direction(3, p);
    // Within a cell the gradient turns by up to √3·s/r; a facet's own normal is
    // off by 0.08/√3.
    EXPECT_LT((outward_normal(ball, Vec3(1, 2, 3) + r * n) - n).norm(),
              std::numbers::sqrt3 * (h / 2) / r + 0.05);
  }
}

TEST_F(MeshShape, BallHasTheBoundsCenterAndSymmetryOfASphere) {
  const Shape ball = mesh_ball();
  EXPECT_LT((center(ball) - Vec3(1, 2, 3)).norm(), 1e-6);  // float samples of size 1: 6e-8 each
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(bounds(ball)->max[axis] - center(ball)[axis], radius,
                facets + interpolation(radius));
  }
  EXPECT_LE(lipschitz_bound(ball), std::sqrt(3.0) + 1e-5);
}

TEST_F(MeshShape, BallHoldsTheVolumeOfItsMesh) {
  Scene scene;
  scene.grid.spacing = h;
  scene.materials.resize(1);
  Body body;
  body.shape = mesh_ball();
  body.sampling = Sampling::lattice;
  body.particles_per_cell = 64;
  scene.bodies = {body};
  // 64·4π/3·6³ = 57906 points; a lattice count errs by about the square root of
  // the number of cells cut, 64^⅔·4π·6² = 7238, here 3 of them; the facets take 3·facets/R.
  EXPECT_NEAR(static_cast<double>(sample_bodies(scene).size()), 64 * 4 * std::numbers::pi / 3 * 216,
              3 * 85 + 57906 * 3 * facets / radius);
}

TEST_F(MeshShape, CubeHasTheDistancesOfABox) {
  const TemporaryFile file("cube.obj", cube_obj);
  const Shape cube = load_mesh_shape(file.path(), 1, Vec3::Zero(), 0.1);
  const Shape box = Box{Vec3::Zero(), Vec3::Ones()};
  const double s = 0.05;
  for (int p = 0; p < 3000; ++p) {
    const Vec3 x = random_point(4, p, Vec3::Constant(0.5), 0.6);
    const double phi = signed_distance(box, x);
    // The samples are exact, so the interpolant is exact wherever the distance
    // is linear over the cell; where two or three faces meet it lies above by
    // at most the distance's own change over half a cell's diagonal.
    EXPECT_NEAR(signed_distance(cube, x), phi, std::numbers::sqrt3 / 2 * s);
    Vec3 from_faces = (x - Vec3::Constant(0.5)).cwiseAbs();
    std::sort(from_faces.data(), from_faces.data() + 3);
    if (phi < 0 && from_faces[2] - from_faces[1] > 2 * s) {
      EXPECT_NEAR(signed_distance(cube, x), phi, 1e-6);  // float samples
      EXPECT_LT((outward_normal(cube, x) - outward_normal(box, x)).norm(), 1e-5);
    }
  }
}

TEST_F(MeshShape, AccuracyIsSecondOrderInTheSpacing) {
  const TemporaryFile file("ball.obj", obj_text(icosphere(5)));
  double error[2] = {};
  for (int refined = 0; refined < 2; ++refined) {
    const Shape ball = load_mesh_shape(file.path(), 1, Vec3::Zero(), refined ? 0.2 : 0.4);
    for (int p = 0; p < 2000; ++p) {
      const Vec3 x = (0.8 + 0.4 * uniform(5, {p})) * random_direction(6, p);
      if (x.cwiseAbs().maxCoeff() > 1.05) continue;
      error[refined] =
          std::max(error[refined], std::abs(signed_distance(ball, x) - (x.norm() - 1)));
    }
  }
  EXPECT_LT(error[0], 0.2 * 0.2 / 4 / 0.6);
  EXPECT_GT(error[0] / error[1], 3);  // 4, less the facets' 0.04²/6
}

/// A ball with a hollow of half its radius and a ball of a quarter in the hollow.
TriangleMesh nested_balls(bool inside_out) {
  TriangleMesh mesh;
  const TriangleMesh ball = icosphere(3);
  for (const double r : {1.0, 0.5, 0.25}) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    for (const Vec3& x : ball.vertices) mesh.vertices.push_back(r * x);
    for (const auto& [a, b, c] : ball.triangles)
      if ((r == 0.5) != inside_out)
        mesh.triangles.push_back({first + a, first + c, first + b});
      else
        mesh.triangles.push_back({first + a, first + b, first + c});
  }
  return mesh;
}

TEST_F(MeshShape, InnerSurfacesAreHollows) {
  for (const bool inside_out : {false, true}) {
    const TemporaryFile file("nested.obj", obj_text(nested_balls(inside_out)));
    const Shape nested = load_mesh_shape(file.path(), 1, Vec3::Zero(), 0.1);
    for (int p = 0; p < 500; ++p) {
      const Vec3 x = random_point(9, p, Vec3::Zero(), 1);
      const double r = x.norm();
      const double phi = std::max(r - 1, std::min(0.5 - r, r - 0.25));
      if (r < 0.2) continue;
      // Halfway between two surfaces the distance has a kink, which the
      // interpolant cuts by up to half a cell's diagonal; facets of sides up to
      // 0.16 lie 0.16²/6 within the sphere.
      EXPECT_NEAR(signed_distance(nested, x), phi, std::numbers::sqrt3 / 2 * 0.05 + 0.0043) << r;
    }
  }
}

TEST(Shells, ArePartsThatHangTogetherByEdges) {
  TriangleMesh mesh = nested_balls(false);
  weld(mesh);
  const std::vector<TriangleMesh> parts = shells(mesh);
  ASSERT_EQ(parts.size(), 3u);
  double sum = 0;
  for (const TriangleMesh& part : parts) {
    EXPECT_EQ(part.triangles.size(), 1280u);
    EXPECT_EQ(part.vertices.size(), 642u);
    require_closed(part, "part");
    sum += signed_volume(part);
  }
  EXPECT_NEAR(sum, signed_volume(mesh), 1e-12);  // 3840 terms of size up to 1
  EXPECT_LT(signed_volume(parts[0]) * signed_volume(parts[1]), 0);
  // 4π/3, less what the facets cut off: 3·0.16²/6.
  EXPECT_NEAR(signed_volume(parts[0]), 4 * std::numbers::pi / 3, 4 * 0.16 * 0.16 / 2);

  // Two tetrahedra that share one vertex are two.
  TriangleMesh touching;
  touching.vertices = {Vec3(0, 0, 0),  Vec3(1, 0, 0),  Vec3(0, 1, 0), Vec3(0, 0, 1),
                       Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)};
  touching.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3},
                        {0, 5, 4}, {0, 4, 6}, {0, 6, 5}, {4, 5, 6}};
  require_closed(touching, "touching");
  ASSERT_EQ(shells(touching).size(), 2u);
  EXPECT_EQ(shells(touching)[1].vertices.size(), 4u);
}

TEST_F(MeshShape, StlAndObjOfTheSameSurfaceAgreeBitForBit) {
  std::string stl = "solid cube\n";
  for (const char* facet :
       {"0 0 0 0 1 0 1 1 0", "0 0 0 1 1 0 1 0 0", "0 0 1 1 0 1 1 1 1", "0 0 1 1 1 1 0 1 1",
        "0 0 0 1 0 0 1 0 1", "0 0 0 1 0 1 0 0 1", "1 0 0 1 1 0 1 1 1", "1 0 0 1 1 1 1 0 1",
        "1 1 0 0 1 0 0 1 1", "1 1 0 0 1 1 1 1 1", "0 1 0 0 0 0 0 0 1", "0 1 0 0 0 1 0 1 1"}) {
    std::string corners = facet;
    stl += "facet normal 0 0 0\nouter loop\nvertex " + corners.substr(0, 5) + "\nvertex " +
           corners.substr(6, 5) + "\nvertex " + corners.substr(12, 5) + "\nendloop\nendfacet\n";
  }
  const TemporaryFile a("cube.STL", stl + "endsolid\n"), b("cube.obj", cube_obj);
  EXPECT_EQ(sampled(load_mesh_shape(a.path(), 2, Vec3::Zero(), 0.3)).values(),
            sampled(load_mesh_shape(b.path(), 2, Vec3::Zero(), 0.3)).values());
}

TEST_F(MeshShape, ColliderMadeOfAMeshMovesAsOneMadeOfASphere) {
  Collider mesh, sphere;
  mesh.shape = mesh_ball();
  sphere.shape = Sphere{Vec3(1, 2, 3), radius};
  for (Collider* c : {&mesh, &sphere}) {
    c->velocity = Vec3(1, 0, -1);
    c->angular_velocity = Vec3(0, 3, 0);
    c->center = Vec3(1, 2, 3.1);
  }
  for (int p = 0; p < 300; ++p) {
    const Vec3 x = sphere.center_at(0.7) + 0.35 * random_direction(7, p) +
                   random_point(8, p, Vec3::Zero(), 0.1);
    const Contact a = mesh.contact(x, 0.7), b = sphere.contact(x, 0.7);
    if (b.phi > 0.02 || b.phi < -0.15) continue;
    EXPECT_NEAR(a.phi, b.phi, facets + interpolation(0.15 - h / 2));
    EXPECT_EQ(a.velocity, b.velocity);
  }
}

TEST_F(MeshShape, RefusalsNameTheFileAndTheReason) {
  const auto error = [](const std::string& name, const std::string& bytes, double scale = 1,
                        double spacing = 0.1) {
    const TemporaryFile file(name, bytes);
    const std::string message =
        input_error([&] { load_mesh_shape(file.path(), scale, Vec3::Zero(), spacing); });
    EXPECT_THAT(message, testing::StartsWith(file.path()));
    EXPECT_EQ(message.find('\n'), std::string::npos);
    return message;
  };
  const std::string open = std::string(cube_obj).substr(0, std::string(cube_obj).size() - 10);
  EXPECT_THAT(error("open.obj", open), HasSubstr("triangles at the edge from"));
  EXPECT_THAT(error("empty.obj", ""), HasSubstr("triangles: got 0"));
  EXPECT_THAT(error("cube.ply", cube_obj), HasSubstr("kind of mesh file: got \".ply\""));
  EXPECT_THAT(error("cube.obj", cube_obj, 1e10), HasSubstr("coordinate after scale"));
  EXPECT_THAT(error("cube.obj", cube_obj, 1, 1e-4), HasSubstr("distance samples"));
  EXPECT_THAT(error("cube.obj", cube_obj, 1e-9, 0.1), HasSubstr("no sample point"));
  EXPECT_THAT(input_error([] { load_mesh_shape("/nowhere/cube.obj", 1, Vec3::Zero(), 0.1); }),
              HasSubstr("/nowhere/cube.obj: file: got one that cannot be opened"));
  EXPECT_THAT(input_error([] { load_level_set_shape("/nowhere/cube.vdb"); }),
              HasSubstr("/nowhere/cube.vdb: OpenVDB cannot read this file"));
}

TEST(MeshShapeWithoutOpenVdb, SaysSo) {
  if (has_openvdb()) GTEST_SKIP() << "built with OpenVDB";
  const TemporaryFile file("cube.obj", cube_obj);
  EXPECT_THAT(input_error([&] { load_mesh_shape(file.path(), 1, Vec3::Zero(), 0.1); }),
              HasSubstr("a build of Firn without OpenVDB"));
  EXPECT_THAT(input_error([] { load_level_set_shape("a.vdb"); }),
              HasSubstr("a build of Firn without OpenVDB"));
}

}  // namespace
}  // namespace firn
