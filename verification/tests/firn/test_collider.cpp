// SPDX-License-Identifier: BSD-3-Clause
// Moving colliders: the velocity they report is that of the material point
// which passes by, and they carry their distances with them.

#include <gtest/gtest.h>

#include "firn/collider.hpp"
#include "verification/support/eps.hpp"
#include "verification/support/points.hpp"

namespace firn {
namespace {

using fixtures::random_point;

Collider tumbling_box() {
  Collider c;
  c.shape = Box{Vec3(-0.5, -0.3, -0.2), Vec3(0.5, 0.4, 0.6)};
  c.velocity = Vec3(1, -2, 0.5);
  c.angular_velocity = Vec3(0.3, 2, -1);
  c.center = Vec3(0.2, 0.1, -0.4);
  return c;
}

/// Where the material point that is at X in the shape's frame finds itself at t,
/// by Eigen's own rotation.
Vec3 path(const Collider& c, const Vec3& X, double t) {
  const double speed = c.angular_velocity.norm();
  const Eigen::AngleAxisd R(speed * t, c.angular_velocity / speed);
  return c.center + t * c.velocity + R * (X - c.center);
}

TEST(Collider, AtRestEqualsItsShapeBitForBit) {
  Collider c;
  c.shape = Sphere{Vec3(1, 2, 3), 0.7};
  c.center = Vec3(0.1, 0.2, 0.3);
  EXPECT_FALSE(c.moves());
  for (int p = 0; p < 100; ++p) {
    const Vec3 x = random_point(1, p, Vec3(1, 2, 3), 2);
    const Contact contact = c.contact(x, 17.3);
    EXPECT_EQ(contact.phi, signed_distance(c.shape, x));
    EXPECT_EQ(contact.normal, outward_normal(c.shape, x));
    EXPECT_EQ(contact.velocity, Vec3::Zero());
    EXPECT_EQ(c.phi(x, 17.3), contact.phi);
  }
}

TEST(Collider, VelocityIsThatOfTheMaterialPointPassingBy) {
  const Collider c = tumbling_box();
  const double step = 1e-4;
  for (int p = 0; p < 200; ++p) {
    const Vec3 X = random_point(2, p, c.center, 1.5);
    const double t = 3 * uniform(3, {p});
    const Vec3 expected = (path(c, X, t + step) - path(c, X, t - step)) / (2 * step);
    // Truncation ω³ r step²/6 = 2.26³·2.6·1e-8/6 = 5e-8; rounding eps·10/step = 2e-11.
    EXPECT_LT((c.contact(path(c, X, t), t).velocity - expected).norm(), 1e-7);
  }
}

TEST(Collider, CarriesItsDistancesAndNormalsAlong) {
  const Collider c = tumbling_box();
  for (int p = 0; p < 200; ++p) {
    const Vec3 X = random_point(4, p, c.center, 1.5);
    const double t = 3 * uniform(5, {p});
    const Vec3 x = path(c, X, t);
    const Contact contact = c.contact(x, t);
    // Coordinates up to 10, turned there and back: some ten roundings.
    EXPECT_NEAR(contact.phi, signed_distance(c.shape, X), 100 * eps);
    EXPECT_EQ(c.phi(x, t), contact.phi);
    EXPECT_NEAR(contact.normal.norm(), 1, 8 * eps);
    EXPECT_LT((c.to_shape_frame(x, t) - X).norm(), 100 * eps);
  }
}

TEST(Collider, NormalIsTheGradientOfPhiInSpace) {
  const Collider c = tumbling_box();
  const double step = 1e-5, t = 1.7;
  int smooth = 0;
  for (int p = 0; p < 200; ++p) {
    const Vec3 x = random_point(6, p, c.center_at(t), 1.5);
    Vec3 difference;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 dx = step * Vec3::Unit(axis);
      difference[axis] = (c.phi(x + dx, t) - c.phi(x - dx, t)) / (2 * step);
    }
    if (difference.norm() < 1 - 1e-6) continue;  // across a medial surface
    ++smooth;
    EXPECT_LT((c.contact(x, t).normal - difference).norm(), 1e-4);  // as for shapes at rest
  }
  EXPECT_GT(smooth, 190);
}

TEST(Collider, IsGalileanInvariant) {
  const Collider at_rest = tumbling_box();
  Collider boosted = at_rest;
  const Vec3 boost(8, -4, 16);
  boosted.velocity += boost;
  for (int p = 0; p < 100; ++p) {
    const Vec3 x = random_point(7, p, at_rest.center, 1.5);
    const double t = 0.75;
    const Contact a = at_rest.contact(x, t), b = boosted.contact(x + t * boost, t);
    EXPECT_NEAR(a.phi, b.phi, 200 * eps);  // coordinates up to 16
    EXPECT_LT((a.normal - b.normal).norm(),
              1e-12);  // edges magnify: 200 eps over a distance ≥ 0.05
    EXPECT_LT((a.velocity + boost - b.velocity).norm(), 200 * eps);
  }
}

TEST(Collider, SpinsAboutItsCenterAsOmegaCrossR) {
  Collider c;
  c.shape = Sphere{Vec3::Zero(), 1};
  c.angular_velocity = Vec3(0, 0, 2);
  c.center = Vec3(1, 0, 0);
  EXPECT_TRUE(c.moves());
  EXPECT_EQ(c.contact(Vec3(4, 0, 5), 0.0).velocity, Vec3(0, 6, 0));
  // Half a turn (π/2 s) takes the sphere's centre from (0,0,0) to (2,0,0).
  EXPECT_NEAR(c.phi(Vec3(2, 0, 0), 1.5707963267948966), -1, 4 * eps);
}

TEST(Collider, InsideTurnsDistanceAndNormalRound) {
  Collider solid;
  solid.shape = Box{Vec3::Zero(), Vec3(1, 1, 1)};
  Collider container = solid;
  container.inside = true;
  for (int p = 0; p < 100; ++p) {
    const Vec3 x = random_point(8, p, Vec3::Constant(0.5), 1);
    const Contact a = solid.contact(x, 0), b = container.contact(x, 0);
    EXPECT_EQ(a.phi, -b.phi);
    EXPECT_EQ(a.normal, -b.normal);
    EXPECT_EQ(container.phi(x, 0), b.phi);
  }
  EXPECT_EQ(container.contact(Vec3(0.25, 0.5, 0.5), 0).normal, Vec3::UnitX());
}

TEST(Collider, VelocityIsZeroAtTheCenterOfRotation) {
  Collider c = tumbling_box();
  EXPECT_LT((c.contact(c.center_at(2), 2).velocity - c.velocity).norm(), 10 * eps);
}

}  // namespace
}  // namespace firn
