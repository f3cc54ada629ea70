// SPDX-License-Identifier: BSD-3-Clause
/// The lists of fields, and what is made of them.

#include <gtest/gtest.h>
#include <limits>
#include <string>

#include "firn/error.hpp"
#include "firn/scene.hpp"
#include "firn/state.hpp"

namespace firn {
namespace {

/// A field that for_each_field forgets would be missing in every file, message and comparison.
/// The sizes say when one was added: particles have 8 arrays, the grid 6 beside `node`.
TEST(State, ForEachFieldVisitsEveryArray) {
  constexpr std::size_t vector = sizeof(std::vector<double>);
  std::size_t particle_arrays = 0, node_arrays = 0;
  Particles particles;
  Grid grid;
  for_each_field([&](const char*, const auto&) { ++particle_arrays; }, particles);
  for_each_field([&](const char*, const auto&) { ++node_arrays; }, grid);
  EXPECT_EQ(particle_arrays * vector, sizeof(Particles));
  EXPECT_EQ((node_arrays + 1) * vector, sizeof(Grid));
}

TEST(State, VisitFieldFindsTheArrayOfEachField) {
  State state;
  state.particles.resize(3);
  state.grid.node.resize(2);
  for_each_field([]<class T>(const char*, std::vector<T>& array) { array.resize(2); }, state.grid);
  for (const Stage stage : all_stages)
    for (const Field field : fields_written(stage)) {
      const bool of_nodes = std::string(name(field)).find("i") != std::string::npos;
      const std::size_t size = visit_field(state, field, [](const auto& a) { return a.size(); });
      EXPECT_EQ(size, of_nodes ? 2u : 3u) << name(field);
    }
}

TEST(State, MatricesAreReadRowByRow) {
  Mat3 F;
  F << 0, 1, 2, 3, 4, 5, 6, 7, 8;
  for (int c = 0; c < 9; ++c) EXPECT_EQ(component(F, c), c);
  EXPECT_EQ(components_of<Mat3>, 9);
}

TEST(State, NewParticlesAreAtRestAndUndeformed) {
  Particles particles;
  particles.resize(2);
  EXPECT_EQ(particles.v[1], Vec3(Vec3::Zero()));
  EXPECT_EQ(particles.F_E[1], Mat3(Mat3::Identity()));
  EXPECT_EQ(particles.V_0[1], 0);
}

TEST(State, NotFiniteNamesTheFirstArrayOfThatParticle) {
  Particles particles;
  particles.resize(2);
  EXPECT_EQ(not_finite(particles, 1), nullptr);
  particles.F_P[1](2, 0) = std::numeric_limits<double>::infinity();
  EXPECT_STREQ(not_finite(particles, 1), "F_P");
  particles.m[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_STREQ(not_finite(particles, 1), "m");
  EXPECT_EQ(not_finite(particles, 0), nullptr);
}

TEST(State, ArraysOfDifferentLengthsAreRefused) {
  Scene scene;
  scene.materials.resize(1);
  Particles particles;
  particles.resize(2);
  EXPECT_NO_THROW(require_consistent(scene, particles));
  particles.F_P.resize(1);
  EXPECT_THROW(require_consistent(scene, particles), InputError);
  particles.resize(2);
  particles.material[1] = 1;
  EXPECT_THROW(require_consistent(scene, particles), InputError);
}

}  // namespace
}  // namespace firn
