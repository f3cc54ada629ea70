// SPDX-License-Identifier: BSD-3-Clause
// Colliders from meshes with walls and openings narrower than a cell: resolved or refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

#include "firn/sampled_distance.hpp"
#include "io/mesh/mesh_shape.hpp"
#include "io/mesh/thin_places.hpp"
#include "verification/support/points.hpp"
#include "verification/tests/io/mesh/meshes.hpp"

namespace firn {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double edge = 0.1;  // of a cell

class ThinPlaces : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_openvdb()) GTEST_SKIP() << "built without OpenVDB";
  }
};

Shape load(const TriangleMesh& mesh) {
  const TemporaryFile file("thin.obj", obj_text(mesh));
  return load_mesh_shape(file.path(), 1, Vec3::Zero(), edge);
}

double spacing(const Shape& shape) { return std::get<SampledShape>(shape).distance->spacing(); }

TriangleMesh turned(TriangleMesh mesh, std::int64_t seed) {
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), fixtures::random_direction(1, seed));
  for (Vec3& x : mesh.vertices) x = turn * x;
  return mesh;
}

TriangleMesh plate(double thickness) {
  return box_mesh(Vec3(-0.25, -0.25, -thickness / 2), Vec3(0.25, 0.25, thickness / 2));
}

// A plate is there for a particle that falls through its middle, at any angle and any thickness
// from 1/8 h on.
TEST_F(ThinPlaces, PlatesHaveAnInsideAtAnyAngle) {
  for (const double thickness : {0.14 * edge, 0.4 * edge, 0.6 * edge})
    for (int seed = 0; seed < 3; ++seed) {
      const Eigen::Quaterniond turn =
          Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), fixtures::random_direction(1, seed));
      const Shape shape = load(turned(plate(thickness), seed));
      int open = 0;
      for (int p = 0; p < 400; ++p) {
        const Vec3 x = fixtures::random_point(2, p, Vec3::Zero(), 0.2);
        open += !(signed_distance(shape, turn * Vec3(x[0], x[1], 0)) < 0);
      }
      EXPECT_EQ(open, 0) << thickness / edge << " h, spacing " << spacing(shape) / edge << " h";
    }
}

TEST_F(ThinPlaces, WallsThatNoSamplesResolveAreRefused) {
  for (int seed = 0; seed < 2; ++seed) {
    const std::string error = input_error([&] { load(turned(plate(0.01 * edge), seed)); });
    EXPECT_THAT(error, HasSubstr("m, allowed: more than the distance of 0.0")) << error;
    EXPECT_THAT(error, HasSubstr("thin.obj: thickness of the wall at ("));
  }
}

/// A block with a slit from its top almost to its bottom.
TriangleMesh slit_block(double width) {
  std::string text;
  const double xs[] = {-0.2, 0.2, 0.2, width / 2, width / 2, -width / 2, -width / 2, -0.2};
  const double zs[] = {-0.2, -0.2, 0.2, 0.2, -0.1, -0.1, 0.2, 0.2};
  for (const double y : {-0.2, 0.2})
    for (int i = 0; i < 8; ++i)
      text += "v " + to_text(xs[i]) + " " + to_text(y) + " " + to_text(zs[i]) + "\n";
  text += "f 1 2 3 4 5 6 7 8\nf 16 15 14 13 12 11 10 9\n";
  for (int i = 1; i <= 8; ++i) {
    const int next = i % 8 + 1;
    text += "f " + std::to_string(next) + " " + std::to_string(i) + " " + std::to_string(i + 8) +
            " " + std::to_string(next + 8) + "\n";
  }
  const TemporaryFile file("slit.obj", text);
  return read_mesh(file.path());
}

TEST_F(ThinPlaces, OpeningsStayOpenOrAreRefused) {
  for (const double width : {0.15 * edge, 0.4 * edge, 0.8 * edge})
    for (int seed = 0; seed < 2; ++seed) {
      const Eigen::Quaterniond turn =
          Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), fixtures::random_direction(1, seed));
      const Shape shape = load(turned(slit_block(width), seed));
      for (int p = 0; p < 200; ++p) {
        const Vec3 x = fixtures::random_point(2, p, Vec3(0, 0, 0.05), 0.1);
        EXPECT_GT(signed_distance(shape, turn * Vec3(0, x[1], x[2])), 0) << width / edge;
      }
    }
  EXPECT_THAT(input_error([&] { load(turned(slit_block(0.01 * edge), 1)); }),
              AllOf(HasSubstr("width of the opening at ("),
                    HasSubstr("): got 0.001 m, allowed: more than")));
}

// One wall of many: a box of thick walls but for one.
TEST_F(ThinPlaces, OneThinWallIsFound) {
  TriangleMesh mesh = box_mesh(Vec3(0, 0, 0), Vec3(0.6, 0.6, 0.6));
  TriangleMesh hollow = box_mesh(Vec3(0.2, 0.2, 0.2), Vec3(0.4, 0.4, 0.597));
  turn_over(hollow);
  append_mesh(mesh, hollow);
  EXPECT_THAT(input_error([&] { load(mesh); }), HasSubstr("thickness of the wall at ("));
  EXPECT_THAT(input_error([&] { load(mesh); }), HasSubstr("0.5985): got 0.003 m, allowed"));
}

TEST_F(ThinPlaces, AClosedFlaskHasAnInside) {
  const TriangleMesh flask = revolved({{0, 0},
                                       {0.3, 0},
                                       {0.3, 0.5},
                                       {0.07, 0.6},
                                       {0.07, 0.8},
                                       {0.03, 0.8},
                                       {0.03, 0.58},
                                       {0.25, 0.47},
                                       {0.25, 0.05},
                                       {0, 0.05}},
                                      32);
  const Shape shape = load(flask);
  EXPECT_GT(signed_distance(shape, Vec3(0, 0, 0.3)), 0.1);
  EXPECT_GT(signed_distance(shape, Vec3(0, 0, 0.7)), 0.01);
}

// What is resolved at h/2 stays at h/2: results of such scenes keep their bits.
TEST_F(ThinPlaces, SolidsWithoutThinPlacesAreSampledAsEver) {
  for (int seed = 0; seed < 3; ++seed) {
    EXPECT_EQ(spacing(load(turned(box_mesh(Vec3(-0.3, -0.4, -0.2), Vec3(0.3, 0.1, 0.2)), seed))),
              edge / 2);
    TriangleMesh wedge;  // edges of 35°, 60° and 85°
    wedge.vertices = {Vec3(0, 0, 0),   Vec3(0.9, 0, 0),   Vec3(0.75, 0.52, 0),
                      Vec3(0, 0, 0.6), Vec3(0.9, 0, 0.6), Vec3(0.75, 0.52, 0.6)};
    wedge.triangles = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                       {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
    EXPECT_EQ(spacing(load(turned(wedge, seed))), edge / 2);
  }
  EXPECT_EQ(spacing(load(icosphere(3))), edge / 2);
}

TEST_F(ThinPlaces, TinyDetailsArePassedOver) {
  TriangleMesh mesh = box_mesh(Vec3(0, 0, 0), Vec3(1, 1, 1));
  append_mesh(mesh, box_mesh(Vec3(2, 0, 0), Vec3(2.01, 0.01, 0.01)));  // a crumb of h/10
  EXPECT_EQ(spacing(load(mesh)), edge / 2);
}

}  // namespace
}  // namespace firn
