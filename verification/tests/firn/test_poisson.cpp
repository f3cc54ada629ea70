// SPDX-License-Identifier: BSD-3-Clause
// Blue noise: nothing closer than the radius, hardly any room left, and the
// density that the samplers count on.

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "firn/poisson.hpp"
#include "verification/support/points.hpp"

namespace firn {
namespace {

using fixtures::random_point;

double smallest_distance(const std::vector<Vec3>& points, const Vec3& period) {
  double smallest = 1e9;
  for (std::size_t p = 0; p < points.size(); ++p)
    for (std::size_t q = 0; q < p; ++q) {
      Vec3 d = points[p] - points[q];
      for (int axis = 0; axis < 3; ++axis)
        if (period[axis] > 0) d[axis] -= period[axis] * std::round(d[axis] / period[axis]);
      smallest = std::min(smallest, d.norm());
    }
  return smallest;
}

const Bounds box{Vec3(-1, 2, 3), Vec3(7, 9, 11)};

TEST(PoissonDisk, NoTwoPointsAreCloserThanTheRadius) {
  const std::vector<Vec3> points = poisson_disk(box, Vec3::Zero(), 1, 5);
  EXPECT_GT(points.size(), 200u);
  EXPECT_GE(smallest_distance(points, Vec3::Zero()), 1 - 1e-15);
  for (const Vec3& x : points) EXPECT_TRUE((x.array() >= box.min.array()).all());
}

TEST(PoissonDisk, NorAcrossASeam) {
  const Vec3 period(8.3, 0, 3.7);
  const std::vector<Vec3> points = poisson_disk(box, period, 1, 5);
  EXPECT_GE(smallest_distance(points, period), 1 - 1e-14);  // the image's own rounding
  for (const Vec3& x : points) {
    EXPECT_LT(x[0], box.min[0] + period[0]);
    EXPECT_LT(x[2], box.min[2] + period[2]);
  }
}

TEST(PoissonDisk, LeavesFewHoles) {
  const std::vector<Vec3> points = poisson_disk(box, Vec3::Zero(), 1, 6);
  int holes = 0;
  for (int p = 0; p < 4000; ++p) {
    const Vec3 x = random_point(7, p, Vec3(3, 5.5, 7), 3);
    double nearest = 1e9;
    for (const Vec3& y : points) nearest = std::min(nearest, (x - y).norm());
    EXPECT_LT(nearest, 1.5);
    holes += nearest > 1;
  }
  EXPECT_LT(holes, 4000 / 10);  // room for another point: a few percent of the volume
}

TEST(PoissonDisk, DensityIsTheStatedOne) {
  // 8000 radii³ a box, period no multiple of the radius. The count of one box
  // scatters by 0.35 %, so the mean of eight by 0.12 %: three of these.
  double points = 0;
  for (int seed = 0; seed < 8; ++seed)
    points += static_cast<double>(poisson_disk(box, Vec3(20.4, 19.7, 20), 1, 100 + seed).size());
  EXPECT_NEAR(points / (8 * 20.4 * 19.7 * 20) / poisson_disk_density, 1, 0.004);
}

TEST(PoissonDisk, SeedsGiveUnrelatedPatternsAndRepeat) {
  const auto a = poisson_disk(box, Vec3::Zero(), 1, 1), b = poisson_disk(box, Vec3::Zero(), 1, 1);
  EXPECT_EQ(a, b);
  const auto c = poisson_disk(box, Vec3::Zero(), 1, 2);
  for (std::size_t p = 0; p < std::min(a.size(), c.size()); ++p) EXPECT_NE(a[p], c[p]);
}

}  // namespace
}  // namespace firn
