// SPDX-License-Identifier: BSD-3-Clause
/// The generator covers what it claims, shrinking ends with something small that still
/// fails, and what was found once stays mended.

#include <filesystem>
#include <gtest/gtest.h>
#include <set>

#include "io/scene/scene_file.hpp"
#include "verification/fuzz/random/compare.hpp"
#include "verification/mutants/mutants.hpp"
#include "verification/support/builtin_registry.hpp"

namespace firn {
namespace {

using fixtures::builtin_registry;
using fixtures::make_reference;

MakeSolver optimized(Precision precision) {
  return [=] {
    SolverOptions options;
    options.precision = precision;
    return builtin_registry().create("optimized", options);
  };
}

TEST(RandomScenes, SameSeedSameScene) {
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    EXPECT_EQ(random_case(seed).scene.toml, random_case(seed).scene.toml);
    EXPECT_NE(random_case(seed).scene.toml, random_case(seed + 1).scene.toml);
  }
}

/// Everything that a scene file can say occurs among 300 scenes.
TEST(RandomScenes, CoverTheSceneSpace) {
  RandomOptions options;
  options.mesh_file = FIRN_MESH_FILE;
  std::set<std::string> seen;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const RandomCase c = random_case(seed, options);
    const Scene& s = c.scene;
    if (c.start_step > 0) seen.insert("start later");
    if (!s.gravity.isZero(0)) seen.insert("gravity");
    if (!s.grid.periodic.isZero(0)) seen.insert("periodic");
    if ((s.grid.periodic.array() > 0).all()) seen.insert("periodic along all axes");
    if (!s.grid.origin.isZero(0)) seen.insert("origin");
    seen.insert(s.time.adaptive ? "adaptive" : "fixed step");
    seen.insert(s.semi_implicit() ? "semi-implicit" : "explicit");
    seen.insert(s.flip == 0 ? "PIC" : s.flip == 1 ? "FLIP" : "blend");
    if (s.materials.size() > 1) seen.insert("two materials");
    for (const Material& m : s.materials) {
      if (m.critical_stretch > 1e3) seen.insert("elastic");
      if (m.hardening == 0) seen.insert("no hardening");
      if (m.poisson_ratio < 0) seen.insert("auxetic");
    }
    if (s.bodies.size() > 1) seen.insert("several bodies");
    for (const Body& b : s.bodies) {
      seen.insert("body " + std::to_string(b.shape.index()));
      seen.insert("sampling " + std::to_string(static_cast<int>(b.sampling)));
      seen.insert(b.volumes == VolumeSource::exact ? "exact" : "estimated");
      if (!b.angular_velocity.isZero(0)) seen.insert("spin");
    }
    if (s.colliders.size() > 1) seen.insert("several colliders");
    for (const Collider& k : s.colliders) {
      seen.insert("collider " + std::to_string(k.shape.index()));
      if (k.sticky) seen.insert("sticky");
      if (!k.sticky && k.friction == 0) seen.insert("slippery");
      if (k.friction > 0) seen.insert("friction");
      if (k.inside) seen.insert("inside");
      if (!k.velocity.isZero(0)) seen.insert("collider moves");
      if (!k.angular_velocity.isZero(0)) seen.insert("collider turns");
    }
  }
  for (const char* feature : {"start later",    "gravity",
                              "periodic",       "periodic along all axes",
                              "origin",         "adaptive",
                              "fixed step",     "semi-implicit",
                              "explicit",       "PIC",
                              "FLIP",           "blend",
                              "two materials",  "elastic",
                              "no hardening",   "auxetic",
                              "several bodies", "body 0",
                              "body 1",         "body 2",
                              "body 5",         "sampling 0",
                              "sampling 1",     "sampling 2",
                              "exact",          "estimated",
                              "spin",           "several colliders",
                              "collider 0",     "collider 1",
                              "collider 2",     "collider 3",
                              "collider 4",     "sticky",
                              "slippery",       "friction",
                              "inside",         "collider moves",
                              "collider turns"})
    EXPECT_TRUE(seen.count(feature)) << feature;
}

/// A solver with one mistake: the scene that shows it becomes a handful of particles.
TEST(RandomScenes, FailuresShrink) {
  const auto subject = [] { return fixtures::builtin_registry().create("mutant:force_sign", {}); };
  const auto fails = [&](const RandomCase& c) {
    return compare(c, make_reference, subject).agreement == Agreement::invalid;
  };
  RandomOptions options;
  options.max_particles = 150;
  std::uint64_t seed = 1;
  while (!fails(random_case(seed, options))) ++seed;
  const RandomCase large = random_case(seed, options);
  const RandomCase small = shrink(large, fails, options.max_particles);
  EXPECT_TRUE(fails(small));
  EXPECT_LE(sample_bodies(small.scene).size(), 8u) << resolved_toml(small.scene);
  EXPECT_EQ(small.scene.colliders.size(), 0u);
  EXPECT_EQ(small.scene.bodies.size(), 1u);
  EXPECT_EQ(small.scene.materials.size(), 1u);
  // What is written is what failed.
  EXPECT_EQ(parse_scene(resolved_toml(small.scene), "again.toml", {}).toml, small.scene.toml);
}

/// Scenes that once failed.
TEST(RandomScenes, FoundOnceStayMended) {
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(FIRN_FOUND)) {
    ++scenes;
    const RandomCase c = {read_scene_file(entry.path()), 0, 3};
    for (const Precision precision : {Precision::float64, Precision::float32}) {
      const Comparison result = compare(c, make_reference, optimized(precision));
      EXPECT_EQ(result.agreement, Agreement::valid) << entry.path() << ": " << result.message;
    }
  }
  EXPECT_GE(scenes, 2);
}

}  // namespace
}  // namespace firn
