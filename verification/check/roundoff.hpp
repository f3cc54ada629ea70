// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// How much roundoff each stage may show, before conditioning: the constants of
/// the model, in units of eps of the subject's precision.
///
/// They count operations of the method itself, not of any one solver: a kernel
/// product is good to about 5 eps, a sum of n terms of one sign to √n eps (see
/// sum()), a polar factor or a singular value to 10–12 eps of the largest
/// singular value, and the sums of step 1, 3, 7, 8 run over one stencil of 64
/// nodes or over the few hundred particles around a node. Rounded up to powers
/// of two. bounds_*.cpp multiply them by the size of the terms and by the
/// condition number of the stage at that particle or node.

#include <algorithm>
#include <cmath>
#include <limits>

#include "firn/types.hpp"

namespace firn::check {

/// A bound this large says that nothing can be said. Finite, so that it goes through
/// sums and products with zero weights unharmed.
inline constexpr double unbounded = 1e100;

struct Roundoff {
  double eps;   ///< spacing of 1: twice the unit roundoff, one for each solver
  double tiny;  ///< smallest normal number; below it relative accuracy ends (and may be flushed)

  static constexpr double node_mass = 32;
  static constexpr double node_velocity = 64;
  static constexpr double volume = 32;
  static constexpr double stress = 64;  ///< of 2μ + 3λ
  static constexpr double deformation = 64;
  static constexpr double particle_velocity = 32;
  static constexpr double velocity_gradient = 16;  ///< of Σ|v_i||∇w|: 64 terms, 12 eps in each ∇w
  static constexpr double few = 8;                 ///< up to four operations on each side
  static constexpr double collision = 10;
  static constexpr double position = 2;

  /// n terms: recursive summation in random order departs like √n eps
  /// (Higham & Mary 2019, theorem 2.4, with λ = 2 unit roundoffs). For the few
  /// hundred particles around a node that is below `base`.
  double sum(double base, double n) const { return eps * std::max(base, std::sqrt(n)); }
};

inline Roundoff roundoff(Precision precision) {
  if (precision == Precision::float64)
    return {std::numeric_limits<double>::epsilon(), std::numeric_limits<double>::min()};
  return {std::numeric_limits<float>::epsilon(), std::numeric_limits<float>::min()};
}

}  // namespace firn::check
