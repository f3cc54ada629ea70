// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Blue noise: random points, no two of them closer than a given distance.

#include <cstdint>
#include <vector>

#include "firn/shape.hpp"

namespace firn {

/// Dart throwing (Cook 1986), also known as random sequential adsorption: darts
/// fall uniformly on a box, one after the other; each that has no earlier point
/// within `radius` stays. A fixed number of darts per radius³ is thrown, so the
/// mean density in points per radius³ is one measured number, below.
///
/// A positive `period` along an axis makes the pattern periodic there, over
/// [low, low + period). The points come sorted by background cell (edge about
/// radius/√3), z fastest, then y, then x.
std::vector<Vec3> poisson_disk(const Bounds& box, const Vec3& period, double radius,
                               std::uint64_t seed);

/// Mean number of points per radius³ that poisson_disk() leaves, measured:
/// 0.57274 ± 0.00009 over 200 periodic boxes of 30³ radii³.
extern const double poisson_disk_density;

}  // namespace firn
