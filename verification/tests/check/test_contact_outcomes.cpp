// SPDX-License-Identifier: BSD-3-Clause
/// Every result that contact may have, each with a bound that holds rounding alone.

#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>

#include "verification/check/contact_outcomes.hpp"
#include "verification/check/roundoff.hpp"

namespace firn::test {
namespace {

using check::ContactOutcome;
using check::ContactOutcomes;

constexpr double eps = 1e-16;

Scene with_collider(Shape shape, double friction = 0.4) {
  Scene scene;
  Collider collider;
  collider.shape = std::move(shape);
  collider.friction = friction;
  scene.colliders.push_back(collider);
  return scene;
}

Scene floor_with_friction() { return with_collider(HalfSpace{Vec3::Zero(), Vec3::UnitZ()}); }

ContactOutcomes at(const Scene& scene, const Vec3& x, const Vec3& v, double v_error,
                   bool projectors = false) {
  return check::contact_outcomes(scene, {x, Vec3::Constant(1e-10), v, v_error}, 0, eps, projectors);
}

TEST(ContactOutcomes, InTheAirNothingIsAdded) {
  const auto all = at(floor_with_friction(), {0, 0, 0.1}, {1, 0, -1}, 1e-9).outcomes;
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].v, Vec3(1, 0, -1));
  EXPECT_EQ(all[0].v_error, 1e-9);
}

TEST(ContactOutcomes, InsideTheBoundIsThatOfTheVelocity) {
  const auto all = at(floor_with_friction(), {0, 0, -0.1}, {1, 0, -1}, 1e-9).outcomes;
  ASSERT_EQ(all.size(), 1u);
  EXPECT_NEAR((all[0].v - Vec3(0.6, 0, 0)).norm(), 0, 1e-15);
  EXPECT_GE(all[0].v_error, 1e-9);
  EXPECT_LE(all[0].v_error, 2e-9);
}

TEST(ContactOutcomes, OnTheSurfaceBothAnswersAreRightAndNothingBetween) {
  const Vec3 free(1, 0, -1), touched(0.6, 0, 0);
  for (const double z : {1e-12, -1e-12}) {
    const ContactOutcomes contact = at(floor_with_friction(), {0, 0, z}, free, 1e-15);
    ASSERT_EQ(contact.outcomes.size(), 2u);
    EXPECT_EQ(contact.doubtful, 0);
    // The reference's own comes first.
    EXPECT_NEAR((contact.outcomes[0].v - (z > 0 ? free : touched)).norm(), 0, 1e-15);
    EXPECT_NEAR((contact.outcomes[1].v - (z > 0 ? touched : free)).norm(), 0, 1e-15);
    for (const ContactOutcome& o : contact.outcomes) EXPECT_LE(o.v_error, 1e-14);
  }
}

TEST(ContactOutcomes, OnTheSurfaceSeparationIsOneAnswer) {
  EXPECT_EQ(at(floor_with_friction(), {0, 0, 1e-12}, {1, 0, 1}, 1e-15).outcomes.size(), 1u);
}

TEST(ContactOutcomes, TwoSurfacesThroughOnePointHaveFourAnswers) {
  Scene scene = floor_with_friction();
  scene.colliders.push_back(scene.colliders[0]);
  scene.colliders[1].shape = HalfSpace{Vec3::Zero(), Vec3::UnitX()};
  EXPECT_EQ(at(scene, Vec3::Zero(), {-1, 0.5, -2}, 1e-15).outcomes.size(), 4u);
}

/// On the diagonal the collider takes the mean of both normals, beside it either.
TEST(ContactOutcomes, OnTheEdgeOfABoxEitherNormalIsRightAndTheirMean) {
  const Scene scene = with_collider(Box{Vec3::Constant(-1), Vec3::Zero()}, 0);
  // Inside, as far from the top as from the side.
  const ContactOutcomes contact = at(scene, {-0.1, -0.5, -0.1}, {-2, 0, -1}, 1e-15);
  ASSERT_EQ(contact.outcomes.size(), 3u);
  EXPECT_EQ(contact.normal, -1);
  EXPECT_NEAR((contact.outcomes[0].v - Vec3(-0.5, 0, 0.5)).norm(), 0, 1e-14);
  double x = 0, z = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    EXPECT_LE(contact.outcomes[k].v_error, 1e-14);
    x += contact.outcomes[k].v[0], z += contact.outcomes[k].v[2];
  }
  EXPECT_NEAR(x, -2, 1e-15);
  EXPECT_NEAR(z, -1, 1e-15);
}

TEST(ContactOutcomes, InTheCentreOfASphereTheNormalMayBeAnything) {
  const ContactOutcomes contact =
      at(with_collider(Sphere{Vec3::Zero(), 1}), Vec3::Zero(), {0, 0, -1}, 1e-15);
  EXPECT_EQ(contact.normal, 0);
  EXPECT_GT(contact.outcomes[0].v_error, 0.5);
}

TEST(ContactOutcomes, WhereContactBeginsOrSlidingEndsTheProjectorIsInDoubtAlone) {
  const Scene scene = floor_with_friction();
  const Vec3 inside(0, 0, -0.1);
  // v_n = 0; on the cone; between them.
  const struct {
    Vec3 v;
    std::size_t outcomes;
  } cases[] = {{{1, 0, 1e-12}, 2}, {{0.4, 0, -1}, 2}, {{1, 0, -1}, 1}};
  for (const auto& each : cases) {
    const auto all = at(scene, inside, each.v, 1e-11, true).outcomes;
    ASSERT_EQ(all.size(), each.outcomes) << each.v.transpose();
    for (const ContactOutcome& o : all) {
      EXPECT_LE((o.v - all[0].v).norm(), 1e-10);
      EXPECT_LE(o.free_error, 1e-9);
    }
    EXPECT_EQ(at(scene, inside, each.v, 1e-11, false).outcomes.size(), 1u);
  }
}

TEST(ContactOutcomes, TheProjectorOfTwoPlanesIsConditionedByTheirAngle) {
  Scene scene = floor_with_friction();
  scene.colliders[0].friction = 0;
  scene.colliders.push_back(scene.colliders[0]);
  for (const double angle : {1.0, 1e-3}) {
    const Vec3 n(std::sin(angle), 0, std::cos(angle));
    scene.colliders[1].shape = HalfSpace{Vec3::Zero(), n};
    const Vec3 inside = -0.1 * Vec3(std::sin(angle / 2), 0, std::cos(angle / 2));
    const auto all = at(scene, inside, {-1, 0, -1}, 1e-15, true).outcomes;
    EXPECT_NEAR((all[0].free - Vec3(0, 1, 0).asDiagonal().toDenseMatrix()).norm(), 0, 1e-12);
    EXPECT_GE(all[0].free_error, 8 * eps / angle);
    EXPECT_LE(all[0].free_error, 100 * eps / angle);
  }
}

}  // namespace
}  // namespace firn::test
