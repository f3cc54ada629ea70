// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Polar decomposition of 3×3 matrices.

#include "reference/svd.hpp"

namespace firn::reference {

/// F = R S with a rotation R (det R = +1 also if det F ≤ 0) and a symmetric S,
/// whose smallest eigenvalue carries the sign of det F.
struct Polar {
  Mat3 R;
  Mat3 S;
};

/// From F = U Σ Vᵀ:  R = U Vᵀ,  S = V Σ Vᵀ.
inline Polar polar(const Svd& F) {
  return {F.U * F.V.transpose(), F.V * F.sigma.asDiagonal() * F.V.transpose()};
}

inline Polar polar(const Mat3& F) { return polar(svd(F)); }

/// R alone.
inline Mat3 rotation(const Mat3& F) {
  const Svd usv = svd(F);
  return usv.U * usv.V.transpose();
}

}  // namespace firn::reference
