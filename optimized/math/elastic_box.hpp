// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Numbers that the return mapping of one material needs, computed once.

#include <cmath>
#include <limits>

namespace firn::kernels {

/// The elastic region [1−θ_c, 1+θ_s] of the singular values of F_E, in the type of the kernels.
template <class T>
struct ElasticBox {
  T lo_minus_1;        ///< −θ_c
  T hi_minus_1;        ///< θ_s
  T minus_inverse_lo;  ///< −1/lo
  T minus_inverse_hi;  ///< −1/hi
  T below;  ///< 1 − lo², less the margin: FᵀF − I + below·I ≻ 0 certifies σ > lo
  T above;  ///< hi² − 1, less the margin: above·I − (FᵀF − I) ≻ 0 certifies σ < hi
  bool bounded;  ///< false: purely elastic, nothing is ever clamped

  /// θ_c in (0, 1), θ_s > 0; infinity for both: purely elastic.
  static ElasticBox from(double theta_c, double theta_s) {
    // The strain is off by at most ~12 roundings of numbers ≤ 4 (F near a half turn), an error
    // of 6 eps in σ² on either side; a further roundoff comes with the factorization. The
    // certificate may err by 4 eps in σ, 8 eps in σ²: a margin of 8 eps keeps clear of that.
    const double margin = 8 * static_cast<double>(std::numeric_limits<T>::epsilon());
    ElasticBox box;
    box.bounded = std::isfinite(theta_c) || std::isfinite(theta_s);
    box.lo_minus_1 = static_cast<T>(-theta_c);
    box.hi_minus_1 = static_cast<T>(theta_s);
    box.minus_inverse_lo = static_cast<T>(-1 / (1 - theta_c));
    box.minus_inverse_hi = static_cast<T>(-1 / (1 + theta_s));
    box.below = static_cast<T>(theta_c * (2 - theta_c) - margin);
    box.above = static_cast<T>(theta_s * (2 + theta_s) - margin);
    if (!box.bounded) box.below = box.above = std::numeric_limits<T>::max();
    return box;
  }
};

}  // namespace firn::kernels
