// SPDX-License-Identifier: BSD-3-Clause
#include "firn/rotation.hpp"

#include <cmath>
#include <cstdint>

namespace firn {

namespace {

/// sin r on |r| ≤ π/4: r + r³ p(r²), Taylor's series to r¹⁷ (error below 2e-19).
double sine_near_zero(double r) {
  const double z = r * r;
  double p = 1.0 / 355687428096000;
  p = p * z - 1.0 / 1307674368000;
  p = p * z + 1.0 / 6227020800;
  p = p * z - 1.0 / 39916800;
  p = p * z + 1.0 / 362880;
  p = p * z - 1.0 / 5040;
  p = p * z + 1.0 / 120;
  p = p * z - 1.0 / 6;
  return r + r * (z * p);
}

/// cos r on |r| ≤ π/4: Taylor's series to r¹⁸ (error below 5e-21).
double cosine_near_zero(double r) {
  const double z = r * r;
  double p = -1.0 / 6402373705728000;
  p = p * z + 1.0 / 20922789888000;
  p = p * z - 1.0 / 87178291200;
  p = p * z + 1.0 / 479001600;
  p = p * z - 1.0 / 3628800;
  p = p * z + 1.0 / 40320;
  p = p * z - 1.0 / 720;
  p = p * z + 1.0 / 24;
  return 1 - (0.5 * z - z * (z * p));
}

}  // namespace

SineCosine sine_cosine(double angle) {
  // θ = quarter·π/2 + r. The head of π/2 has 33 bits, so that quarter·head is
  // exact for every quarter below 2²⁰ (Cody and Waite 1980).
  constexpr double half_pi_head = 0x1.921fb544p+0, half_pi_tail = 0x1.0b4611a626331p-34;
  const double quarter = std::floor(angle * 0x1.45f306dc9c883p-1 + 0.5);  // 2/π
  const double r = (angle - quarter * half_pi_head) - quarter * half_pi_tail;
  const double s = sine_near_zero(r), c = cosine_near_zero(r);
  switch (static_cast<int>(quarter - 4 * std::floor(quarter / 4))) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
  }
}

/// Rodrigues: R = cos θ I + sin θ [a]× + (1 − cos θ) a aᵀ.
Mat3 rotation_about(const Vec3& axis, double angle) {
  const auto [s, c] = sine_cosine(angle);
  const auto [half_sine, half_cosine] = sine_cosine(angle / 2);
  const double versine = 2 * half_sine * half_sine;  // 1 − cos θ without cancellation
  Mat3 R = versine * axis * axis.transpose();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    R(i, i) += c;
    R(k, j) += s * axis[i];
    R(j, k) -= s * axis[i];
  }
  return R;
}

}  // namespace firn
