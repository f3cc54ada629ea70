// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The cubic B-spline from which all weights are made (Stomakhin et al. 2013,
/// section 4):
///
///     N(x) =  |x|³/2 − x² + 2/3            0 ≤ |x| < 1
///            −|x|³/6 + x² − 2|x| + 4/3     1 ≤ |x| < 2
///             0                            otherwise
///
/// The outer branch is evaluated in its factored form, (2 − |x|)³/6, and its
/// derivative as −(2 − |x|)²/2. As printed, the polynomial adds terms of size 1
/// to obtain a result that goes to 0 at |x| = 2: for 2 − |x| = 1e-5 the relative
/// error in double is larger than 1, weights become negative, and the velocity
/// of a node, which is a ratio of two sums of such weights, is wrong where the
/// node is light. The factored form has a relative error of a few units of
/// roundoff everywhere.

#include <cmath>
#include <cstdint>

#include "firn/scene.hpp"

namespace firn::reference {

/// N at distance d in [0, 1] from the node.
constexpr double N_inner(double d) { return (0.5 * d - 1) * d * d + 2.0 / 3.0; }

/// N at distance t = 2 − d in [0, 1] from the end of its support.
constexpr double N_outer(double t) { return t * t * t / 6; }

/// dN/dd at distance d in [0, 1] from the node.
constexpr double dN_inner(double d) { return (1.5 * d - 2) * d; }

/// dN/dd at distance t = 2 − d in [0, 1] from the end of its support.
constexpr double dN_outer(double t) { return -0.5 * t * t; }

/// N(x), x in units of h.
inline double N(double x) {
  const double d = std::abs(x);
  if (d < 1) return N_inner(d);
  if (d < 2) return N_outer(2 - d);
  return 0;
}

/// N'(x) = sign(x) dN/dd(|x|), N'(0) = 0.
inline double dN(double x) {
  const double d = std::abs(x);
  if (d < 1) return std::copysign(1.0, x) * dN_inner(d);
  if (d < 2) return std::copysign(1.0, x) * dN_outer(2 - d);
  return 0;
}

/// The values of N and N' at the four nodes around a point which lies the
/// fraction s in [0, 1] of a cell beyond the second of them. The distances are
/// 1 + s, s, 1 − s, 2 − s. For the two outer ones it is 2 − d = 1 − s and s that
/// are exact in floating point, and the factored branches want just these.
inline void kernel_row(double s, double (&N)[4], double (&dN)[4]) {
  N[0] = N_outer(1 - s);
  N[1] = N_inner(s);
  N[2] = N_inner(1 - s);
  N[3] = N_outer(s);
  dN[0] = dN_outer(1 - s);
  dN[1] = dN_inner(s);
  dN[2] = -dN_inner(1 - s);
  dN[3] = -dN_outer(s);
}

/// The spline on the grid of a scene: all that the rest of the reference knows of its order.
class Kernel {
 public:
  Kernel() = default;
  explicit Kernel(const GridSettings& grid) : h_(grid.spacing), origin_(grid.origin) {}

  static constexpr int width = 4;  ///< nodes along an axis within reach of a point

  /// The weights of a point along one axis.
  struct Row {
    std::int32_t first;  ///< index of the first node
    double N[width];     ///< N((x_p − x_i)/h)  [1]
    double dN[width];    ///< derivative with respect to x_p, N'((x_p − x_i)/h)/h  [1/m]
  };

  /// For the coordinate x_p [m] along `axis`. The first of the four nodes is the one before the
  /// cell: floor((x_p − origin)/h) − 1. Floor, not truncation: coordinates may be negative.
  Row row(int axis, double x_p) const {
    const double X = (x_p - origin_[axis]) / h_;
    const double cell = std::floor(X);
    Row row;
    row.first = static_cast<std::int32_t>(cell) - 1;
    kernel_row(X - cell, row.N, row.dN);
    for (double& dN : row.dN) dN /= h_;
    return row;
  }

 private:
  double h_ = 1;
  Vec3 origin_ = Vec3::Zero();
};

}  // namespace firn::reference
