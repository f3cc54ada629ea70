// SPDX-License-Identifier: BSD-3-Clause
/// `firn compare`: differences that were put there are found where they are.

#include <cmath>
#include <gtest/gtest.h>

#include "firn/error.hpp"
#include "io/trajectory/compare.hpp"
#include "io/trajectory/writer.hpp"
#include "verification/support/scenes.hpp"
#include "verification/support/temporary_folder.hpp"

namespace firn {
namespace {

using fixtures::odd_particles;
using fixtures::TemporaryFolder;

/// Frames at t = 0, 0.1, 0.2 s of five particles, ids 4 … 0.
std::vector<State> three_frames() {
  std::vector<State> frames;
  for (int k = 0; k < 3; ++k) {
    State state;
    state.time = 0.1 * k;
    state.particles = odd_particles(5);
    frames.push_back(state);
  }
  return frames;
}

std::filesystem::path write(const std::filesystem::path& path, const std::vector<State>& frames) {
  TrajectoryWriter writer(path, {}, static_cast<std::int64_t>(frames[0].particles.size()), 0,
                          static_cast<std::int64_t>(frames.size()), 0);
  for (const State& state : frames) writer.write_frame(state, {});
  writer.finish();
  return path;
}

const QuantityComparison& quantity(const TrajectoryComparison& result, const std::string& name) {
  for (const QuantityComparison& q : result.quantities)
    if (q.name == name) return q;
  throw std::logic_error("no such quantity");
}

class Compare : public ::testing::Test {
 protected:
  TrajectoryComparison compare(const std::vector<State>& a, const std::vector<State>& b,
                               const CompareOptions& options = {}) {
    return compare_trajectories(write(folder_ / "a.vtkhdf", a), write(folder_ / "b.vtkhdf", b),
                                options);
  }
  TemporaryFolder folder_;
};

TEST_F(Compare, FindsNothingBetweenEqualFiles) {
  const auto result = compare(three_frames(), three_frames());
  EXPECT_TRUE(result.identical());
  EXPECT_EQ(result.frames_matched, 3);
  ASSERT_EQ(result.quantities.size(), 7u);
  for (const QuantityComparison& q : result.quantities) {
    EXPECT_EQ(q.compared, 15) << q.name;
    EXPECT_EQ(q.different, 0) << q.name;
    EXPECT_FALSE(q.worst) << q.name;
  }
}

TEST_F(Compare, MatchesParticlesByIdWhateverTheirOrder) {
  auto b = three_frames();
  for (State& state : b) {
    for_each_field([](const char*, auto& array) { std::swap(array[0], array[3]); },
                   state.particles);
  }
  EXPECT_TRUE(compare(three_frames(), b).identical());
}

TEST_F(Compare, NamesTheWorstParticleAndTheFirstFrame) {
  auto b = three_frames();
  b[1].particles.v[2][1] += 0.5;
  b[2].particles.v[4] += Vec3(3, 4, 0);
  const auto result = compare(three_frames(), b);
  EXPECT_FALSE(result.identical());
  EXPECT_TRUE(quantity(result, "position").identical);
  const QuantityComparison v = quantity(result, "velocity");
  EXPECT_EQ(v.different, 2);
  EXPECT_EQ(*v.first_different_time, 0.1);
  ASSERT_TRUE(v.worst);
  EXPECT_EQ(v.worst->id, 0);  // the fifth particle
  EXPECT_EQ(v.worst->frame_a, 2);
  EXPECT_EQ(v.worst->a[0] + 3, v.worst->b[0]);
  // ‖(3,4,0)‖ = 5 up to the rounding of the sums above; RMS over 15 comparisons.
  const double eps = std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(v.max_absolute, 5, 8 * eps * 5);
  EXPECT_NEAR(v.rms_absolute, std::sqrt((25 + 0.25) / 15), 8 * eps);
  EXPECT_NEAR(v.max_relative, 5 / b[2].particles.v[4].norm(), 8 * eps);
}

TEST_F(Compare, CountsOneBit) {
  auto b = three_frames();
  double& m = b[0].particles.m[1];
  m = std::nextafter(m, 1);
  const auto result = compare(three_frames(), b);
  EXPECT_FALSE(result.identical());
  EXPECT_EQ(quantity(result, "mass").different, 1);
  EXPECT_GT(quantity(result, "mass").max_absolute, 0);
}

TEST_F(Compare, ReportsFramesAndParticlesWithoutPartner) {
  auto a = three_frames(), b = three_frames();
  a.erase(a.begin() + 1);
  b.pop_back();
  for (State& state : b) state.particles.id[0] = 77;
  const auto result = compare(a, b);
  EXPECT_EQ(result.frames_matched, 1);
  EXPECT_EQ(result.only_in_a, std::vector<double>{0.2});
  EXPECT_EQ(result.only_in_b, std::vector<double>{0.1});
  ASSERT_EQ(result.particle_mismatches.size(), 1u);
  EXPECT_EQ(result.particle_mismatches[0].only_in_a, 1);
  EXPECT_EQ(result.particle_mismatches[0].only_in_b, 1);
  EXPECT_EQ(quantity(result, "mass").compared, 4);
  EXPECT_FALSE(result.identical());
}

TEST_F(Compare, MatchesTimesThatRoundingSeparates) {
  auto b = three_frames();
  b[2].time = std::nextafter(b[2].time, 1);
  const auto result = compare(three_frames(), b);
  EXPECT_EQ(result.frames_matched, 3);
  EXPECT_FALSE(result.times_identical);
  EXPECT_FALSE(result.identical());
  b[2].time = 0.21;
  EXPECT_EQ(compare(three_frames(), b).frames_matched, 2);
  EXPECT_EQ(compare(three_frames(), b, {.time_tolerance = 0.011}).frames_matched, 3);
}

TEST_F(Compare, MatchesTimesThatAnotherProgramKeptIn32Bits) {
  auto b = three_frames();
  for (State& state : b) state.time = static_cast<double>(static_cast<float>(state.time));
  const auto result = compare(three_frames(), b);
  EXPECT_EQ(result.frames_matched, 3);
  EXPECT_FALSE(result.identical());
  EXPECT_EQ(result.max_time_difference, static_cast<double>(0.2f) - 0.2);
  EXPECT_EQ(compare(b, three_frames()).frames_matched, 3);
  auto a = three_frames();
  a[2].time *= 1 + 1e-6;
  EXPECT_EQ(compare(a, b).frames_matched, 2) << "16 roundings away is another time";
}

TEST_F(Compare, RefusesAnIdThatIsThereTwice) {
  auto b = three_frames();
  b[1].particles.id[0] = b[1].particles.id[1];
  EXPECT_THROW(compare(three_frames(), b), InputError);
}

}  // namespace
}  // namespace firn
