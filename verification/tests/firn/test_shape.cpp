// SPDX-License-Identifier: BSD-3-Clause
// Shapes: distances against pencil-sized cases and against the nearest of many
// points spread over the surface; normals against finite differences.

#include <gtest/gtest.h>
#include <limits>
#include <numbers>

#include "firn/shape.hpp"
#include "verification/support/eps.hpp"
#include "verification/support/points.hpp"

namespace firn {
namespace {

using fixtures::random_direction;
using fixtures::random_point;

// Distances here are of size 1 and made of a few operations on numbers up to 3.
constexpr double rounding = 16 * eps;

TEST(Sphere, DistancesOnAPencilSizedCase) {
  const Shape s = Sphere{Vec3(1, 2, 3), 2};
  EXPECT_EQ(signed_distance(s, Vec3(1, 2, 3)), -2);
  EXPECT_EQ(signed_distance(s, Vec3(4, 6, 3)), 3);
  EXPECT_EQ(signed_distance(s, Vec3(1, 2, 5)), 0);
  EXPECT_EQ(outward_normal(s, Vec3(4, 6, 3)), Vec3(3.0 / 5, 4.0 / 5, 0));
  EXPECT_EQ(center(s), Vec3(1, 2, 3));
  EXPECT_EQ(bounds(s)->min, Vec3(-1, 0, 1));
  EXPECT_EQ(bounds(s)->max, Vec3(3, 4, 5));
}

TEST(Box, DistancesOutsideFaceEdgeAndCornerAreEuclidean) {
  const Shape b = Box{Vec3(0, 0, 0), Vec3(2, 4, 6)};
  EXPECT_EQ(signed_distance(b, Vec3(1, 2, 9)), 3);       // a face
  EXPECT_EQ(signed_distance(b, Vec3(1, 7, 10)), 5);      // an edge: 3, 4
  EXPECT_EQ(signed_distance(b, Vec3(-2, -3, 12)), 7);    // a corner: 2, 3, 6
  EXPECT_EQ(signed_distance(b, Vec3(0.5, 2, 3)), -0.5);  // inside: the nearest face
  EXPECT_EQ(signed_distance(b, Vec3(1, 2, 3)), -1);
  EXPECT_EQ(outward_normal(b, Vec3(0.5, 2, 3)), Vec3(-1, 0, 0));
  EXPECT_EQ(outward_normal(b, Vec3(1, 7, 10)), Vec3(0, 3.0 / 5, 4.0 / 5));
  EXPECT_EQ(center(b), Vec3(1, 2, 3));
}

TEST(Cylinder, DistancesOutsideSideCapAndRimAreEuclidean) {
  const Shape c = Cylinder{Vec3::Zero(), Vec3(0, 0, 10), 2, 6};
  EXPECT_EQ(signed_distance(c, Vec3(0, 5, 1)), 3);   // the side
  EXPECT_EQ(signed_distance(c, Vec3(1, 0, -5)), 2);  // a cap
  EXPECT_EQ(signed_distance(c, Vec3(5, 0, 7)), 5);   // the rim: 3, 4
  EXPECT_EQ(signed_distance(c, Vec3(0, 0, 0)), -2);
  EXPECT_EQ(signed_distance(c, Vec3(0, 0, 2.5)), -0.5);
  EXPECT_EQ(outward_normal(c, Vec3(0, 0, 2.5)), Vec3(0, 0, 1));
  EXPECT_EQ(outward_normal(c, Vec3(0, 1.5, 0)), Vec3(0, 1, 0));
  EXPECT_EQ(bounds(c)->min, Vec3(-2, -2, -3));
  EXPECT_EQ(bounds(c)->max, Vec3(2, 2, 3));
}

TEST(HalfSpace, SolidIsOnTheSideAwayFromTheNormal) {
  const Shape s = HalfSpace{Vec3(0, 0, 1), Vec3(0, 0, 5)};
  EXPECT_EQ(signed_distance(s, Vec3(7, 8, 3)), 2);
  EXPECT_EQ(signed_distance(s, Vec3(7, 8, -3)), -4);
  EXPECT_EQ(outward_normal(s, Vec3(7, 8, 9)), Vec3::UnitZ());
  EXPECT_FALSE(bounds(s).has_value());
  EXPECT_EQ(center(s), Vec3(0, 0, 1));
}

// Brute force: the distance is that to the nearest of the points spread over
// the surface. With a point within `gap` of every surface point the brute-force
// distance d' lies in [d, √(d² + gap²)] for a flat neighbourhood, [d, d + gap] always.

struct Cloud {
  std::vector<Vec3> points;
  double gap;
};

Cloud box_surface(const Box& b, int n) {
  Cloud cloud;
  const Vec3 size = b.max - b.min;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int p = 0; p <= n; ++p)
        for (int q = 0; q <= n; ++q) {
          Vec3 u;
          u[axis] = side;
          u[(axis + 1) % 3] = double(p) / n;
          u[(axis + 2) % 3] = double(q) / n;
          cloud.points.push_back(b.min + u.cwiseProduct(size));
        }
  cloud.gap = size.maxCoeff() / n * std::numbers::sqrt2 / 2;
  return cloud;
}

Cloud cylinder_surface(const Cylinder& c, int n) {
  Cloud cloud;
  const Vec3 a = c.axis.normalized();
  const Vec3 e = a.cross(Vec3(0.3, 0.5, -0.7)).normalized(), f = a.cross(e);
  for (int p = 0; p < 4 * n; ++p) {
    const double angle = 2 * std::numbers::pi * p / (4 * n);
    const Vec3 radial = std::cos(angle) * e + std::sin(angle) * f;
    for (int q = 0; q <= n; ++q) {
      cloud.points.push_back(c.center + c.radius * radial + c.height * (double(q) / n - 0.5) * a);
      for (const double cap : {-0.5, 0.5})
        cloud.points.push_back(c.center + c.radius * q / n * radial + cap * c.height * a);
    }
  }
  const double arc = 2 * std::numbers::pi * c.radius / (4 * n);
  cloud.gap = (std::max(c.height, c.radius) / n + arc) / 2;
  return cloud;
}

void expect_nearest_of(const Cloud& cloud, const Shape& shape, const Vec3& middle) {
  int outside = 0;
  for (int p = 0; p < 300; ++p) {
    const Vec3 x = random_point(1, p, middle, 2.5);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& y : cloud.points) nearest = std::min(nearest, (x - y).norm());
    const double phi = signed_distance(shape, x);
    EXPECT_LE(std::abs(phi), nearest + rounding) << x.transpose();
    EXPECT_GE(std::abs(phi), nearest - cloud.gap) << x.transpose();
    outside += phi > 0;
  }
  EXPECT_GT(outside, 50);
  EXPECT_LT(outside, 290);
}

TEST(BruteForce, BoxDistanceIsThatToTheNearestSurfacePoint) {
  const Box b{Vec3(-1, -0.5, -1.5), Vec3(1, 1, 0.5)};
  expect_nearest_of(box_surface(b, 60), b, center(b));
}

TEST(BruteForce, SlantedCylinderDistanceIsThatToTheNearestSurfacePoint) {
  const Cylinder c{Vec3(0.2, -0.1, 0.4), Vec3(1, -2, 3), 1.1, 2.3};
  expect_nearest_of(cylinder_surface(c, 60), c, c.center);
}

// What holds for every analytic shape ----------------------------------------

class AnalyticShape : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, AnalyticShape,
                         testing::Values(Shape(Sphere{Vec3(0.1, 0.2, 0.3), 0.9}),
                                         Shape(Box{Vec3(-0.8, -0.7, -0.6), Vec3(0.9, 1, 1.1)}),
                                         Shape(Cylinder{Vec3(0.1, 0, -0.1), Vec3(3, -1, 2), 0.7,
                                                        1.4}),
                                         Shape(Cylinder{Vec3::Zero(), Vec3(0, 0, -1), 0.9, 0.4}),
                                         Shape(HalfSpace{Vec3(0, 0.1, 0.2), Vec3(1, 2, -2)})));

TEST_P(AnalyticShape, NormalIsTheGradient) {
  const Shape& shape = GetParam();
  const double step = 1e-5;
  int smooth = 0;
  for (int p = 0; p < 500; ++p) {
    const Vec3 x = random_point(2, p, Vec3::Zero(), 2);
    const Vec3 n = outward_normal(shape, x);
    EXPECT_NEAR(n.norm(), 1, 4 * eps);
    Vec3 difference;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 dx = step * Vec3::Unit(axis);
      difference[axis] =
          (signed_distance(shape, x + dx) - signed_distance(shape, x - dx)) / (2 * step);
    }
    // On the medial surfaces there is no gradient: the difference is shorter than 1 there.
    if (difference.norm() < 1 - 1e-6) continue;
    ++smooth;
    // Truncation step²/6·|φ'''| with |φ'''| ≤ 2/d² at distance d from a centre of
    // curvature, cut off below by the norm test above; rounding eps/step.
    EXPECT_LT((n - difference).norm(), 1e-4) << x.transpose();
  }
  EXPECT_GT(smooth, 480);
}

TEST_P(AnalyticShape, WalkingDownTheNormalReachesTheSurface) {
  const Shape& shape = GetParam();
  for (int p = 0; p < 500; ++p) {
    const Vec3 x = random_point(3, p, Vec3::Zero(), 2);
    const double phi = signed_distance(shape, x);
    EXPECT_NEAR(signed_distance(shape, x - phi * outward_normal(shape, x)), 0, rounding);
  }
}

TEST_P(AnalyticShape, DistanceIsLipschitz) {
  const Shape& shape = GetParam();
  EXPECT_EQ(lipschitz_bound(shape), 1);
  for (int p = 0; p < 500; ++p) {
    const Vec3 x = random_point(4, p, Vec3::Zero(), 2), y = random_point(5, p, Vec3::Zero(), 2);
    const double change = std::abs(signed_distance(shape, x) - signed_distance(shape, y));
    EXPECT_LE(change, (x - y).norm() + rounding);
  }
}

TEST_P(AnalyticShape, ContainsIsNegativeDistance) {
  const Shape& shape = GetParam();
  int held = 0;
  for (int p = 0; p < 500; ++p) {
    const Vec3 x = random_point(6, p, Vec3::Zero(), 2);
    EXPECT_EQ(contains(shape, x), signed_distance(shape, x) < 0);
    held += contains(shape, x);
  }
  EXPECT_GT(held, 5);
}

TEST_P(AnalyticShape, BoundsHoldTheSolidAndTouchIt) {
  const Shape& shape = GetParam();
  const std::optional<Bounds> b = bounds(shape);
  if (!b) return;
  for (int p = 0; p < 2000; ++p) {
    const Vec3 x = random_point(7, p, Vec3::Zero(), 2);
    if (!contains(shape, x)) continue;
    EXPECT_TRUE((x.array() >= b->min.array()).all() && (x.array() <= b->max.array()).all());
  }
  // Every face of the bounds is touched: a plane just inside it meets the solid,
  // at the point where a walk along the face's direction ends.
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      double furthest = -1e9;
      for (int p = 0; p < 20000; ++p) {
        Vec3 x = center(shape) + 3 * random_direction(8, p);
        for (int walk = 0; walk < 3; ++walk)
          x -= signed_distance(shape, x) * outward_normal(shape, x);
        furthest = std::max(furthest, side * x[axis]);
      }
      const double face = side > 0 ? b->max[axis] : -b->min[axis];
      EXPECT_LE(furthest, face + rounding);
      // 20000 surface points lie about 0.02 apart; a round surface drops by 0.02²
      // over that, the rim of a slanted cylinder by up to 0.02.
      EXPECT_GE(furthest, face - 0.03);
    }
}

// Points where the gradient does not exist -------------------------------------

TEST(DegeneratePoints, HaveAFixedUnitNormal) {
  EXPECT_EQ(outward_normal(Sphere{Vec3(1, 1, 1), 1}, Vec3(1, 1, 1)), Vec3::UnitZ());
  const Shape cube = Box{Vec3::Zero(), Vec3::Constant(2)};
  // Equally near faces share the normal, so that a symmetric edge deflects to neither side.
  EXPECT_EQ(outward_normal(cube, Vec3(1, 1, 1)), Vec3(1, 1, 1).normalized());
  EXPECT_EQ(outward_normal(cube, Vec3(2, 2, 1)), Vec3(1, 1, 0).normalized());      // on an edge
  EXPECT_EQ(outward_normal(cube, Vec3(1.5, 1.5, 1)), Vec3(1, 1, 0).normalized());  // below it
  EXPECT_EQ(outward_normal(cube, Vec3(0, 0, 0)), Vec3(-1, -1, -1).normalized());   // at a corner
  const Shape can = Cylinder{Vec3::Zero(), Vec3::UnitZ(), 1, 2};
  EXPECT_EQ(outward_normal(can, Vec3(0.5, 0, 0.5)), Vec3(1, 0, 1).normalized());
  const Shape tube = Cylinder{Vec3::Zero(), Vec3(1, 2, 3), 1, 10};
  const Vec3 n = outward_normal(tube, Vec3::Zero());  // on the axis
  EXPECT_NEAR(n.norm(), 1, 4 * eps);
  EXPECT_NEAR(n.dot(Vec3(1, 2, 3)), 0, 16 * eps);
  EXPECT_EQ(outward_normal(Cylinder{Vec3::Zero(), Vec3::UnitZ(), 9, 2}, Vec3::Zero()),
            Vec3::UnitZ());  // in the middle plane of a flat one
}

TEST(DegeneratePoints, TinyOffsetsDoNotUnderflow) {
  const Vec3 n = outward_normal(Sphere{Vec3::Zero(), 1}, Vec3(3e-200, 0, 4e-200));
  EXPECT_NEAR(n[0], 0.6, 4 * eps);
  EXPECT_NEAR(n[2], 0.8, 4 * eps);
  EXPECT_EQ(outward_normal(HalfSpace{Vec3::Zero(), Vec3(0, 1e-300, 0)}, Vec3(1, 1, 1)),
            Vec3::UnitY());
  const Shape far = Cylinder{Vec3::Zero(), Vec3(0, 0, 1e200), 1, 2};
  EXPECT_EQ(signed_distance(far, Vec3(0, 3, 0)), 2);
}

// Membership of points exactly on a surface -------------------------------------

TEST(Boundary, MinimumIsIncludedMaximumExcluded) {
  const Shape b = Box{Vec3(0, 0, 0), Vec3(1, 1, 1)};
  EXPECT_TRUE(contains(b, Vec3(0, 0, 0)));
  EXPECT_TRUE(contains(b, Vec3(0, 0.5, 0.5)));
  EXPECT_FALSE(contains(b, Vec3(1, 0.5, 0.5)));
  EXPECT_FALSE(contains(b, Vec3(0, 1, 0)));
  const Shape s = Sphere{Vec3(1, 1, 1), 1};
  const Shape c = Cylinder{Vec3(1, 1, 1), Vec3(0, 0, -1), 1, 2};
  for (int axis = 0; axis < 3; ++axis)
    for (const Shape* shape : {&s, &c}) {
      EXPECT_TRUE(contains(*shape, Vec3(Vec3(1, 1, 1) - Vec3::Unit(axis))));
      EXPECT_FALSE(contains(*shape, Vec3(Vec3(1, 1, 1) + Vec3::Unit(axis))));
    }
  EXPECT_TRUE(contains(HalfSpace{Vec3::Zero(), -Vec3::UnitZ()}, Vec3(5, 6, 0)));
  EXPECT_FALSE(contains(HalfSpace{Vec3::Zero(), Vec3::UnitZ()}, Vec3(5, 6, 0)));
}

TEST(Boundary, AdjoiningBoxesShareNoPointAndMissNone) {
  const Shape left = Box{Vec3(0, 0, 0), Vec3(1, 2, 2)}, right = Box{Vec3(1, 0, 0), Vec3(2, 2, 2)};
  const Shape whole = Box{Vec3(0, 0, 0), Vec3(2, 2, 2)};
  for (int i = -1; i <= 5; ++i)
    for (int j = -1; j <= 5; ++j)
      for (int k = -1; k <= 5; ++k) {
        const Vec3 x = 0.5 * Vec3(i, j, k);
        EXPECT_EQ(contains(left, x) + contains(right, x), int(contains(whole, x)));
      }
}

}  // namespace
}  // namespace firn
