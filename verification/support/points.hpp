// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Random points and directions for the geometry tests.

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>

#include "firn/random.hpp"
#include "firn/types.hpp"

namespace firn::fixtures {

/// Point p of a stream, uniform in the cube [−half, half]³ around `middle`.
inline Vec3 random_point(std::uint64_t stream, std::int64_t p, const Vec3& middle, double half) {
  Vec3 x;
  for (int axis = 0; axis < 3; ++axis)
    x[axis] = middle[axis] + half * (2 * uniform(stream, {p, axis}) - 1);
  return x;
}

/// Unit vector p of a stream.
inline Vec3 random_direction(std::uint64_t stream, std::int64_t p) {
  for (std::int64_t attempt = 0;; ++attempt) {
    const Vec3 x = random_point(stream + 0x100000, 1000 * p + attempt, Vec3::Zero(), 1);
    if (x.norm() < 1 && x.norm() > 0.1) return x.normalized();
  }
}

}  // namespace firn::fixtures
