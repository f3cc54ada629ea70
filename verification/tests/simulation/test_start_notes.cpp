// SPDX-License-Identifier: BSD-3-Clause
// What `firn run` says of a scene before its first step.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firn/sampling.hpp"
#include "simulation/start_notes.hpp"

namespace firn {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A solid that says what its volume is.
struct ToldVolume final : Solid {
  bool contains(const Vec3& x) const override { return firn::contains(box, x); }
  double distance(const Vec3& x) const override { return signed_distance(box, x); }
  Vec3 normal(const Vec3& x) const override { return outward_normal(box, x); }
  Bounds bounds() const override { return {box.min, box.max}; }
  std::optional<double> volume() const override { return told; }

  Box box;
  std::optional<double> told;
};

/// Two bodies of 1000 and 125 particles on cells of edge 0.1, at rest on z = 0.
Scene two_boxes() {
  Scene scene;
  scene.grid.spacing = 0.1;
  scene.materials.resize(1);
  for (const Box& box :
       {Box{Vec3(0, 0, 0), Vec3(1, 1, 1)}, Box{Vec3(2, 0, 0), Vec3(2.5, 0.5, 0.5)}}) {
    Body body;
    body.shape = box;
    body.particles_per_cell = 1;
    body.sampling = Sampling::lattice;
    scene.bodies.push_back(body);
  }
  Collider floor;
  floor.shape = HalfSpace{};
  scene.colliders.push_back(floor);
  return scene;
}

std::vector<std::string> notes(const Scene& scene) {
  std::vector<std::size_t> counts;
  const Particles particles = sample_bodies(scene, counts);
  return start_notes(scene, particles, counts);
}

TEST(StartNotes, NothingOddIsNoNote) { EXPECT_THAT(notes(two_boxes()), IsEmpty()); }

TEST(StartNotes, ParticlesOnTheSurfaceAreNotInside) {
  Scene scene = two_boxes();
  std::get<HalfSpace>(scene.colliders[0].shape).point[2] = 0.05;  // the lowest layer
  EXPECT_THAT(notes(scene), IsEmpty());
}

TEST(StartNotes, CountParticlesInsideACollider) {
  Scene scene = two_boxes();
  Collider ball;
  ball.shape = Sphere{Vec3(2.25, 0.25, 0.25), 0.12};  // one particle in the middle, six around it
  scene.colliders.push_back(ball);
  EXPECT_THAT(
      notes(scene),
      ElementsAre("body[1]: 7 of 125 particles begin inside collider[1], up to 0.12 m deep"));
  std::get<HalfSpace>(scene.colliders[0].shape).point[2] = 0.17;  // two layers
  EXPECT_THAT(
      notes(scene),
      ElementsAre("body[0]: 200 of 1000 particles begin inside collider[0], up to 0.12 m deep",
                  "body[1]: 50 of 125 particles begin inside collider[0], up to 0.12 m deep",
                  "body[1]: 7 of 125 particles begin inside collider[1], up to 0.12 m deep"));
}

TEST(StartNotes, ContainersAreColliders) {
  Scene scene = two_boxes();
  scene.colliders[0].shape = Box{Vec3(-1, -1, -1), Vec3(2.4, 2, 2)};
  scene.colliders[0].inside = true;
  EXPECT_THAT(
      notes(scene),
      ElementsAre("body[1]: 25 of 125 particles begin inside collider[0], up to 0.05 m deep"));
}

TEST(StartNotes, VolumesOfMeshes) {
  Scene scene = two_boxes();
  const auto solid = std::make_shared<ToldVolume>();
  solid->box = Box{Vec3(0, 0, 0), Vec3(1, 1, 1)};
  scene.bodies[0].shape = SolidShape{solid};
  for (const double volume : {1.0, 0.96, 1.04}) {
    solid->told = volume;
    EXPECT_THAT(notes(scene), IsEmpty()) << volume;
  }
  solid->told = 0.8;
  EXPECT_THAT(notes(scene),
              ElementsAre("body[0]: 1000 particles fill 1 m³, the mesh encloses 0.8 m³ "
                          "(+25 %): more particles per cell or sampling = "
                          "\"jittered\" come nearer"));
  solid->told = 2;
  scene.bodies[0].sampling = Sampling::jittered;
  EXPECT_THAT(notes(scene), ElementsAre("body[0]: 1000 particles fill 1 m³, the mesh encloses 2 m³ "
                                        "(-50 %): more particles per cell come nearer"));
}

}  // namespace
}  // namespace firn
