// What the solver leaves out changes nothing: each skip switched off gives the same bits.

#include <cstdlib>
#include <gtest/gtest.h>

#include "firn/error.hpp"
#include "verification/optimized/snow.hpp"

namespace firn::test {
namespace {

class Skips : public testing::TestWithParam<Precision> {
 protected:
  void TearDown() override { unsetenv("FIRN_NO_SKIP"); }

  State run(const Scene& scene, const char* without) {
    EXPECT_EQ(setenv("FIRN_NO_SKIP", without, 1), 0);
    const auto solver = optimized(GetParam(), 2);
    State state = initial_state(scene);
    solver->load(scene, state);
    for (int n = 0; n < 24; ++n) solver->step(scene.time.step);
    solver->store(state);
    return state;
  }
};

/// A block is skipped only where the Lipschitz bound of φ excludes contact.
TEST_P(Skips, ContactOutOfReach) {
  for (const Scene& scene : {collision_of_everything(), periodic_snow(false)})
    EXPECT_TRUE(same_bits(run(scene, ""), run(scene, "contact")));
}

/// Certified particles are inside the box; where the return map finds nothing to
/// clamp it keeps every bit. The certificate may err by 4 eps at a limit, where the
/// return map would clamp by as much: no particle of these scenes sits there.
TEST_P(Skips, ReturnMapOfElasticParticles) {
  for (const Scene& scene : {collision_of_everything(), periodic_snow(true)})
    EXPECT_TRUE(same_bits(run(scene, ""), run(scene, "box")));
}

TEST_P(Skips, AnUnknownNameIsRefused) {
  ASSERT_EQ(setenv("FIRN_NO_SKIP", "box,physics", 1), 0);
  EXPECT_THROW(optimized(GetParam()), InputError);
}

INSTANTIATE_TEST_SUITE_P(Precisions, Skips, testing::Values(Precision::float64, Precision::float32),
                         [](const auto& info) { return std::string(name(info.param)) + "_"; });

}  // namespace
}  // namespace firn::test
