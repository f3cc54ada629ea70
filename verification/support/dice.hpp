#pragma once
/// A sequence of random numbers, the same on every machine.

#include <cmath>
#include <cstdint>

#include "firn/random.hpp"
#include "firn/types.hpp"

namespace firn {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : seed_(seed) {}

  double between(double low, double high) {
    return low + (high - low) * uniform(seed_, {count_++});
  }
  /// Uniform in the logarithm; 0 < low < high.
  double log_between(double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  }
  /// low … high, both included.
  int integer(int low, int high) {
    return low + static_cast<int>(uniform(seed_, {count_++}) * (high - low + 1));
  }
  bool chance(double probability) { return uniform(seed_, {count_++}) < probability; }

  /// Each component in [−size, size].
  Vec3 vector(double size) {
    const double x = between(-size, size), y = between(-size, size), z = between(-size, size);
    return {x, y, z};
  }

 private:
  std::uint64_t seed_;
  std::int64_t count_ = 0;
};

}  // namespace firn
