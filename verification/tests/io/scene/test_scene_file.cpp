// SPDX-License-Identifier: BSD-3-Clause
// Scenes from TOML: every key arrives where it belongs, defaults are neutral,
// and the resolved text gives the same scene again.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

#include "firn/error.hpp"
#include "io/mesh/mesh_shape.hpp"
#include "io/scene/builtin_scenes.hpp"
#include "io/scene/scene_file.hpp"
#include "io/trajectory/writer.hpp"
#include "verification/support/temporary_folder.hpp"

namespace firn {
namespace {

std::string full_scene() {
  std::ifstream file(FIRN_SOURCE_DIR "/verification/fuzz/corpus/scene/every_key.toml");
  return {std::istreambuf_iterator<char>(file), {}};
}

Scene parse(const std::string& text, const SceneOptions& options = {}) {
  return parse_scene(text, "test.toml", {}, options);
}

TEST(SceneFile, EveryKeyArrives) {
  const Scene scene = parse(full_scene());
  EXPECT_EQ(scene.name, "every key");
  EXPECT_EQ(scene.gravity, Vec3(0.1, 0.2, -9.81));
  EXPECT_EQ(scene.grid.spacing, 0.05);
  EXPECT_EQ(scene.grid.origin, Vec3(0.5, 0.25, -0.125));
  EXPECT_EQ(scene.grid.periodic, Vec3(0, 0.8, 0));
  EXPECT_EQ(scene.grid.period_nodes(1), 16);
  EXPECT_EQ(scene.time.end, 1.0);
  EXPECT_FALSE(scene.time.adaptive);
  EXPECT_EQ(scene.time.step, 1e-4);
  EXPECT_EQ(scene.time.frames_per_second, 48);
  EXPECT_TRUE(scene.semi_implicit());
  EXPECT_EQ(scene.integrator.implicitness, 0.5);
  EXPECT_EQ(scene.integrator.tolerance, 1e-6);
  EXPECT_EQ(scene.integrator.max_iterations, 77);
  EXPECT_EQ(scene.flip, 0.9);

  ASSERT_EQ(scene.materials.size(), 2u);
  const Material& snow = scene.materials[0];
  EXPECT_EQ(snow.name, "snow");
  EXPECT_EQ(snow.youngs_modulus, 1.4e5);
  EXPECT_EQ(snow.poisson_ratio, 0.2);
  EXPECT_EQ(snow.density, 400);
  EXPECT_EQ(snow.hardening, 10);
  EXPECT_EQ(snow.critical_compression, 2.5e-2);
  EXPECT_EQ(snow.critical_stretch, 7.5e-3);
  EXPECT_EQ(scene.materials[1].name, "rubber \"soft\"");
  EXPECT_TRUE(std::isinf(scene.materials[1].critical_compression));
  EXPECT_TRUE(std::isinf(scene.materials[1].critical_stretch));

  ASSERT_EQ(scene.bodies.size(), 2u);
  const Body& ball = scene.bodies[0];
  EXPECT_EQ(ball.material, 1);
  EXPECT_EQ(std::get<Sphere>(ball.shape).center, Vec3(0, 0.1, 1));
  EXPECT_EQ(std::get<Sphere>(ball.shape).radius, 0.3);
  EXPECT_EQ(ball.particles_per_cell, 8);
  EXPECT_EQ(ball.sampling, Sampling::jittered);
  EXPECT_EQ(ball.seed, 5u);
  EXPECT_EQ(ball.velocity, Vec3(1, 2, 3));
  EXPECT_EQ(ball.angular_velocity, Vec3(0.4, 0.5, 0.6));
  EXPECT_EQ(ball.volumes, VolumeSource::exact);
  const Body& box = scene.bodies[1];
  EXPECT_EQ(box.material, 0);
  EXPECT_EQ(box.sampling, Sampling::lattice);
  EXPECT_EQ(box.particles_per_cell, 27);
  EXPECT_EQ(std::get<Box>(box.shape).min, Vec3(-1, -0.1, 0));
  EXPECT_EQ(std::get<Box>(box.shape).max, Vec3(-0.8, 0.2, 0.3));
  EXPECT_EQ(box.volumes, VolumeSource::estimated);
  EXPECT_EQ(box.velocity, Vec3(0, 0, 0));

  ASSERT_EQ(scene.colliders.size(), 2u);
  const Collider& plane = scene.colliders[0];
  EXPECT_EQ(std::get<HalfSpace>(plane.shape).point, Vec3(0, 0, 0.013));
  EXPECT_EQ(std::get<HalfSpace>(plane.shape).normal, Vec3(0, 0.6, 0.8));
  EXPECT_EQ(plane.friction, 0.3);
  EXPECT_FALSE(plane.sticky);
  EXPECT_FALSE(plane.inside);
  EXPECT_EQ(plane.velocity, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(plane.angular_velocity, Vec3(0.7, 0.8, 0.9));
  EXPECT_EQ(plane.center, Vec3(4, 5, 6));
  const Collider& drum = scene.colliders[1];
  EXPECT_EQ(std::get<Cylinder>(drum.shape).axis, Vec3(0, 2, 0));
  EXPECT_EQ(std::get<Cylinder>(drum.shape).height, 8);
  EXPECT_TRUE(drum.sticky);
  EXPECT_TRUE(drum.inside);
  EXPECT_EQ(drum.center, Vec3(0, 0, 3)) << "the shape's centre unless stated";
}

TEST(SceneFile, ResolvedTextIsAFixedPoint) {
  const Scene scene = parse(full_scene());
  const Scene again = parse(scene.toml);
  EXPECT_EQ(again.toml, scene.toml);
  EXPECT_EQ(sample_bodies(again).x, sample_bodies(scene).x);
}

TEST(SceneFile, NegativeZeroKeepsItsSign) {
  std::string text = full_scene();
  const std::string from = "velocity = [1.0, 2.0, 3.0]";
  text.replace(text.find(from), from.size(), "velocity = [-0.0, 2.0, 3.0]");
  const Scene again = parse(parse(text).toml);
  EXPECT_TRUE(std::signbit(again.bodies[0].velocity.x()));
}

/// A trajectory of one frame, and the state in it.
State write_trajectory(const std::filesystem::path& path) {
  State state = initial_state(find_scene("two_particles"));
  state.particles.F_E[0](0, 1) = 0.1;
  state.particles.F_P[1](2, 2) = 0.9;
  TrajectoryWriter writer(path, {"nobody", Precision::float64, 1, "0", "none", ""}, 2, 0, 1, 0);
  writer.write_frame(state, {});
  writer.finish();
  return state;
}

TEST(SceneFile, ParticlesComeFromTheLastFrame) {
  const fixtures::TemporaryFolder temporary;
  const auto folder = temporary / "firn scene \"quoted\"";
  std::filesystem::create_directories(folder);
  const State state = write_trajectory(folder / "state.vtkhdf");
  std::string text = full_scene();
  const std::size_t begin = text.find("[[body]]"), end = text.find("[[collider]]");
  text.replace(begin, end - begin,
               "[[body]]\nmaterial = 'rubber \"soft\"'\nvelocity = [0, 0, 1]\n"
               "shape = { type = 'particles', file = 'state.vtkhdf' }\n");
  const Scene scene = parse_scene(text, "test.toml", folder);
  const Scene again = parse_scene(scene.toml, "again.toml", "/nowhere");
  EXPECT_EQ(again.toml, scene.toml) << "named by its absolute path";
  for (const Scene& each : {scene, again}) {
    const Particles particles = sample_bodies(each);
    ASSERT_EQ(particles.size(), 2u);
    for (std::size_t p = 0; p < 2; ++p) {
      EXPECT_EQ(particles.x[p], each.wrap(state.particles.x[p]));
      EXPECT_EQ(particles.v[p], state.particles.v[p] + Vec3(0, 0, 1)) << "velocity is added";
      EXPECT_EQ(particles.m[p], state.particles.m[p]);
      EXPECT_EQ(particles.V_0[p], state.particles.V_0[p]);
      EXPECT_EQ(particles.F_E[p], state.particles.F_E[p]);
      EXPECT_EQ(particles.F_P[p], state.particles.F_P[p]);
      EXPECT_EQ(particles.material[p], 1) << "the body's, not the file's";
    }
  }
}

TEST(SceneFile, MeshesKeepTheirFileAndPlace) {
  const fixtures::TemporaryFolder temporary;
  const auto& folder = temporary.path();
  // A cube of edge 1, with its corner at the origin.
  std::ofstream(folder / "cube.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
         "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  std::string text = full_scene();
  const std::string from = "shape = { type = \"sphere\", center = [0.0, 0.1, 1.0], radius = 0.3 }";
  ASSERT_NE(text.find(from), std::string::npos);
  text.replace(text.find(from), from.size(),
               "shape = { type = \"mesh\", file = \"cube.obj\", scale = 0.4, "
               "translate = [-0.2, 0.0, 2.0] }");
  if (!has_openvdb()) {
    EXPECT_THROW(parse_scene(text, "test.toml", folder), InputError);
    return;
  }
  const Scene scene = parse_scene(text, "test.toml", folder);
  const Shape& cube = scene.bodies[0].shape;
  EXPECT_LT(signed_distance(cube, Vec3(0, 0.2, 2.2)), 0);
  EXPECT_LT((center(cube) - Vec3(0, 0.2, 2.2)).norm(), scene.grid.spacing / 2)
      << "distances are sampled every h/2";
  const Scene again = parse_scene(scene.toml, "again.toml", "/nowhere");
  EXPECT_EQ(again.toml, scene.toml);
  EXPECT_EQ(sample_bodies(again).x, sample_bodies(scene).x);
}

TEST(SceneFile, ScaleRefinesGridAndSteps) {
  SceneOptions twice;
  twice.scale = 2;
  const Scene coarse = parse(full_scene()), fine = parse(full_scene(), twice);
  EXPECT_EQ(fine.grid.spacing, coarse.grid.spacing / 2);
  EXPECT_EQ(fine.grid.periodic, coarse.grid.periodic);
  EXPECT_EQ(fine.time.step, coarse.time.step / 2);
  EXPECT_EQ(fine.time.end, coarse.time.end);
  const double ratio = static_cast<double>(sample_bodies(fine).size()) /
                       static_cast<double>(sample_bodies(coarse).size());
  // A surface of some 7e2 cells, each filled or not by chance: a percent or two of 1.4e4 particles.
  EXPECT_NEAR(ratio, 8, 0.3);
  EXPECT_EQ(parse(fine.toml).toml, fine.toml) << "resolved text is refined already";
}

TEST(SceneFile, AnExistingFileIsReadAndNamesAreBuiltIn) {
  const fixtures::TemporaryFolder temporary;
  const auto& folder = temporary.path();
  std::filesystem::current_path(folder);
  std::ofstream("column.toml") << full_scene();
  std::ofstream("column") << full_scene();
  std::ofstream("mine") << full_scene();
  EXPECT_EQ(find_scene("column.toml").name, "every key");
  EXPECT_EQ(find_scene("./column").name, "every key");
  EXPECT_EQ(find_scene((folder / "mine").string()).name, "every key");
  EXPECT_EQ(find_scene("column").name, "column") << "a bare name is a built-in scene first";
  EXPECT_EQ(find_scene("mine").name, "every key") << "and a file after that";
}

TEST(BuiltinScenes, AreSortedDescribedAndReadable) {
  ASSERT_FALSE(builtin_scenes().empty());
  for (const BuiltinScene& scene : builtin_scenes()) {
    SCOPED_TRACE(scene.name);
    EXPECT_FALSE(scene.description.empty());
    const Scene parsed = find_scene(scene.name);
    EXPECT_EQ(parse(parsed.toml).toml, parsed.toml);
  }
}

}  // namespace
}  // namespace firn
