// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Random numbers, vectors and matrices for tests, suites, studies and benchmarks.

#include <random>

#include "firn/types.hpp"
#include "verification/support/random_numbers.hpp"

namespace firn::fixtures {

template <class Engine>
class RandomOf : public NumbersOf<Engine> {
 public:
  using NumbersOf<Engine>::NumbersOf;

  /// Each component in [−1, 1).
  Vec3 vec3() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }
  /// Each component in [−size, size).
  Vec3 vector(double size) {
    const double x = this->uniform(-size, size), y = this->uniform(-size, size),
                 z = this->uniform(-size, size);
    return {x, y, z};
  }
  /// Drawn row by row.
  Mat3 mat3() {
    Mat3 m;
    for (int row = 0; row < 3; ++row) m.row(row) = vec3();
    return m;
  }
};

using Random = RandomOf<std::mt19937_64>;
/// For what is drawn scene by scene: neighbouring seeds are unrelated.
using Dice = RandomOf<HashedCount>;

}  // namespace firn::fixtures
