// SPDX-License-Identifier: BSD-3-Clause
// What the solver leaves out changes nothing: each skip switched off gives the same bits.

#include <cstdlib>
#include <gtest/gtest.h>

#include "firn/error.hpp"
#include "verification/tests/optimized/snow_scenes.hpp"

namespace firn::test {
namespace {

struct Result {
  State state;
  double bytes_per_particle = 0;
};

class Skips : public testing::TestWithParam<Precision> {
 protected:
  void TearDown() override { unsetenv("FIRN_NO_SKIP"); }

  Result run(const Scene& scene, const char* without) {
    EXPECT_EQ(setenv("FIRN_NO_SKIP", without, 1), 0);
    const auto solver = optimized(GetParam());
    Result result{initial_state(scene), 0};
    solver->load(scene, result.state);
    for (int n = 0; n < 24; ++n) solver->step(scene.time.step);
    solver->store(result.state);
    result.bytes_per_particle = solver->bytes_per_particle();
    return result;
  }

  /// The same bits with and without, in scenes where the skip applies to some particles,
  /// to all and to none.
  void expect_same_bits(const char* skip) {
    for (const Scene& scene :
         {collision_of_everything(), periodic_snow(true), periodic_snow(false), block_at_rest()})
      EXPECT_TRUE(same_bits(run(scene, "").state, run(scene, skip).state)) << skip;
  }
};

/// Certified particles are inside the box; where the return map finds nothing to
/// clamp it keeps every bit. The certificate may err by 4 eps at a limit, where the
/// return map would clamp by as much: no particle of these scenes sits there.
TEST_P(Skips, ReturnMapOfElasticParticles) { expect_same_bits("box"); }

/// A block is skipped only where the Lipschitz bound of φ excludes contact.
TEST_P(Skips, ContactOutOfReach) { expect_same_bits("contact"); }

/// Nodes that no particle reaches have no mass and contribute to nobody.
TEST_P(Skips, EmptySpace) { expect_same_bits("empty"); }

/// Node fields are read by the pass that computes them and by nobody else.
TEST_P(Skips, FieldsThatNobodyReads) { expect_same_bits("fields"); }

/// 1 + 0·v_n/slip = 1.
TEST_P(Skips, FrictionOfFrictionlessColliders) { expect_same_bits("friction"); }

/// The same F_P gives the same exponential.
TEST_P(Skips, HardeningWhereNothingYields) { expect_same_bits("hardening"); }

/// What is not written back is what was read.
TEST_P(Skips, FlowOfVectorsThatDoNotYield) { expect_same_bits("plastic"); }

/// F_E = I exactly: the stress is 0 and so is its share in every node's force.
TEST_P(Skips, StressOfUndeformedParticles) { expect_same_bits("rest"); }

/// Volumes are written where they were unknown only.
TEST_P(Skips, VolumesAfterTheFirstStep) { expect_same_bits("volumes"); }

/// A scene with one material needs no note of it; it saves the memory of one number.
TEST_P(Skips, MaterialOfParticlesInAUniformScene) {
  expect_same_bits("material");
  const double with = run(block_at_rest(), "").bytes_per_particle;
  const double without = run(block_at_rest(), "material").bytes_per_particle;
  EXPECT_GE(without - with, GetParam() == Precision::float32 ? 4 : 8);
}

TEST_P(Skips, AllAtOnce) { expect_same_bits("all"); }

TEST_P(Skips, AnUnknownNameIsRefused) {
  ASSERT_EQ(setenv("FIRN_NO_SKIP", "box,physics", 1), 0);
  EXPECT_THROW(optimized(GetParam()), InputError);
}

INSTANTIATE_TEST_SUITE_P(Precisions, Skips, testing::Values(Precision::float64, Precision::float32),
                         [](const auto& info) { return std::string(name(info.param)) + "_"; });

}  // namespace
}  // namespace firn::test
