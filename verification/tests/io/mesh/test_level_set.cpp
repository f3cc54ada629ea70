// SPDX-License-Identifier: BSD-3-Clause
// Level-set files as shapes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  EXPECT_THAT(error(write_vdb_empty), HasSubstr("without a surface"));
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
