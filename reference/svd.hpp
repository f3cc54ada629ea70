// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Singular value decomposition of 3×3 matrices.

#include "firn/types.hpp"

namespace firn::reference {

/// A = U Σ Vᵀ with *rotations* U and V: det U = det V = +1, and therefore
/// σ1 ≥ σ2 ≥ |σ3|, the sign of det A on σ3.
struct Svd {
  Mat3 U;
  Vec3 sigma;
  Mat3 V;
};

/// One-sided Jacobi (Hestenes 1958) to full working accuracy for every finite
/// matrix: backward error and orthogonality within 10 units of 2^-52, singular
/// values within 6 of them relative to σ1. All NaN if A is not finite.
Svd svd(const Mat3& A);

}  // namespace firn::reference
