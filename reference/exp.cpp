// SPDX-License-Identifier: BSD-3-Clause
#include "reference/exp.hpp"

#include <cmath>
#include <limits>

namespace firn::reference {

namespace {

/// 1/n! for n = 2 … 13. On |r| ≤ ln(2)/2 the first neglected term, r¹⁴/14!, is
/// below 5e-18, a fiftieth of a unit in the last place.
constexpr int terms = 12;
constexpr double inverse_factorial[terms] = {
    1.0 / 2,     1.0 / 6,      1.0 / 24,      1.0 / 120,      1.0 / 720,       1.0 / 5040,
    1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};

/// ln 2 in two parts; the upper one has 21 trailing zero bits, so that k·ln2_high
/// is exact for every exponent k of a double.
constexpr double ln2_high = 0x1.62e42feep-1;
constexpr double ln2_low = 0x1.a39ef35793c76p-33;
constexpr double inverse_ln2 = 0x1.71547652b82fep+0;

}  // namespace

double exp(double x) {
  if (std::isnan(x)) return x;
  if (x > 709.79) return std::numeric_limits<double>::infinity();
  if (x < -745.14) return 0;

  // eˣ = 2ᵏ e^(r + r_low),  r + r_low = x − k ln 2,  |r| ≤ ln(2)/2
  const double k = std::nearbyint(x * inverse_ln2);
  const double high = x - k * ln2_high;
  const double low = -k * ln2_low;
  const double r = high + low;
  const double r_low = (high - r) + low;

  // e^r − 1 − r by Taylor's series, from the smallest term to the largest
  double q = inverse_factorial[terms - 1];
  for (int n = terms - 2; n >= 0; --n) q = q * r + inverse_factorial[n];
  const double rest = q * r * r + r_low;

  // 1 + r in two parts, so that the only rounding of size 1 is the last one
  const double sum = 1 + r;
  const double sum_low = (1 - sum) + r;
  return std::ldexp(sum + (sum_low + rest), static_cast<int>(k));
}

}  // namespace firn::reference
