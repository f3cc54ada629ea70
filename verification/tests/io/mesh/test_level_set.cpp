// SPDX-License-Identifier: BSD-3-Clause
// Level-set files as shapes.

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "firn/sampled_distance.hpp"
#include "io/mesh/mesh_shape.hpp"
#include "verification/support/points.hpp"
#include "verification/tests/io/mesh/meshes.hpp"
#include "verification/tests/io/mesh/vdb_files.hpp"

namespace firn {
namespace {

using fixtures::random_point;

using testing::HasSubstr;

constexpr double s = 0.05, radius = 0.6;

TEST(LevelSet, SphereHasTheDistancesOfASphereAlsoBeyondItsBand) {
  const Vec3 middle(1, -2, 0.5);
  const TemporaryFile file("sphere.vdb", "");
  write_vdb_sphere(file.path(), middle, radius, s);
  const Shape shape = load_level_set_shape(file.path());
  int deep = 0;
  for (int p = 0; p < 3000; ++p) {
    const Vec3 x = random_point(1, p, middle, 0.7);
    const double r = (x - middle).norm();
    if (r < 3 * s) continue;
    // Within the band the file's own samples: interpolation s²/4r. Beyond it the
    // distance to the surface that OpenVDB meshes: its corners, means of points
    // on voxel edges, lie up to s²/8R within the sphere, the middles of its
    // quads, of diagonal √3 s, another 3s²/8R.
    const double bound = s * s / 4 / (r - s) + s * s / 2 / radius;
    if ((x - middle).cwiseAbs().maxCoeff() < radius) {
      EXPECT_NEAR(signed_distance(shape, x), r - radius, bound) << r;
    }
    if (r < radius) {
      EXPECT_LT((outward_normal(shape, x) - (x - middle) / r).norm(), 2 * s / r) << r;
    }
    deep += r < radius - 4 * s;
  }
  EXPECT_GT(deep, 200);
  EXPECT_LT((center(shape) - middle).norm(), 1e-6);
}

TEST(LevelSet, IsTheFirstInItsFile) {
  const TemporaryFile file("two.vdb", "");
  write_vdb_fog_and_sphere(file.path(), radius, s);
  EXPECT_NEAR(signed_distance(load_level_set_shape(file.path()), Vec3(radius, 0, 0)), 0, s * s);
}

TEST(LevelSet, IsFoundByName) {
  const TemporaryFile file("named.vdb", "");
  write_vdb_named(file.path(), radius, s);
  const auto at_surface = [&](const std::string& name, double r) {
    return signed_distance(load_level_set_shape(file.path(), name), Vec3(r, 0, 0));
  };
  EXPECT_NEAR(at_surface("", radius), 0, s * s);
  EXPECT_NEAR(at_surface("ball", radius), 0, s * s);
  EXPECT_NEAR(at_surface("pearl", radius / 2), 0, s * s);
  for (const char* name : {"mist", "Ball", "box"})
    EXPECT_EQ(input_error([&] { load_level_set_shape(file.path(), name); }),
              file.path() + ": level set: got \"" + name +
                  "\", allowed: the file's level sets, \"ball\", \"pearl\"");
}

TEST(LevelSet, ValuesThatAreNotFiniteAreRefused) {
  const TemporaryFile file("nan.vdb", "");
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float value : {std::nanf(""), -std::nanf(""), infinity, -infinity})
    for (const int i : {13, 12, 2}) {  // beside the surface, in it, and deep inside
      write_vdb_with_value(file.path(), radius, s, i, value);
      EXPECT_THAT(
          input_error([&] { load_level_set_shape(file.path()); }),
          testing::StartsWith(file.path() + ": voxel (" + std::to_string(i) + ", 0, 0): got "))
          << value;
    }
}

TEST(LevelSet, SignsThatJumpAreRefused) {
  const TemporaryFile file("jump.vdb", "");
  write_vdb_unflooded(file.path(), radius, s);
  EXPECT_THAT(input_error([&] { load_level_set_shape(file.path()); }),
              testing::AllOf(HasSubstr("change of sign to voxel ("), HasSubstr("never flooded")));
  // One wrong sign in the band; the voxel at 14 s is 2 s outside.
  write_vdb_with_value(file.path(), radius, s, 14, static_cast<float>(-2 * s));
  EXPECT_THAT(input_error([&] { load_level_set_shape(file.path()); }),
              HasSubstr("change of sign to voxel (14, 0, 0) from its neighbour: got a jump by"));
}

TEST(LevelSet, RefusalsNameTheFileAndTheReason) {
  const auto error = [](void (*write)(const std::string&)) {
    const TemporaryFile file("bad.vdb", "");
    write(file.path());
    const std::string message = input_error([&] { load_level_set_shape(file.path()); });
    EXPECT_THAT(message, testing::StartsWith(file.path()));
    return message;
  };
  EXPECT_THAT(error(write_vdb_fog), HasSubstr("no level set of floats"));
  EXPECT_THAT(error(write_vdb_stretched), HasSubstr("cubes along the axes"));
  EXPECT_THAT(error(write_vdb_turned), HasSubstr("cubes along the axes"));
  EXPECT_THAT(error(write_vdb_empty), HasSubstr("without active voxels"));
  const TemporaryFile text("text.vdb", "this is not a VDB file");
  EXPECT_THAT(input_error([&] { load_level_set_shape(text.path()); }),
              HasSubstr("OpenVDB cannot read this file"));
}

TEST(LevelSet, FilesCutShortAreRefused) {
  const TemporaryFile whole("sphere.vdb", "");
  write_vdb_sphere(whole.path(), Vec3::Zero(), radius, s);
  std::ifstream stream(whole.path(), std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  for (int part = 1; part < 16; ++part) {
    const TemporaryFile cut("cut.vdb", bytes.substr(0, bytes.size() * part / 16));
    const std::string message = input_error([&] { load_level_set_shape(cut.path()); });
    EXPECT_THAT(message, HasSubstr("OpenVDB cannot read this file")) << part;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace firn
