// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The fixed corotated stress and the return mapping in long double, from the definitions.

#include <array>
#include <cmath>

#include "verification/oracles/svd_oracle.hpp"

namespace firn::verification {

/// I + D
inline Matrix plus_identity(Matrix D) {
  D[0] += 1, D[4] += 1, D[8] += 1;
  return D;
}

/// FFᵀ − I of F = I + D, without cancellation.
inline Matrix left_strain(const Matrix& D) {
  Matrix E = multiply(D, transpose(D));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) E[3 * i + j] += D[3 * i + j] + D[3 * j + i];
  return E;
}

/// det(I + D) − 1, without cancellation.
inline Real det_minus_one(const Matrix& D) {
  const Real minors =
      D[0] * D[4] - D[1] * D[3] + D[0] * D[8] - D[2] * D[6] + D[4] * D[8] - D[5] * D[7];
  return D[0] + D[4] + D[8] + minors + det(D);
}

/// Eigenvalues and eigenvectors (columns) of a symmetric matrix: classical two-sided Jacobi.
struct Eigen3 {
  std::array<Real, 3> values;
  Matrix vectors;
};

inline Eigen3 symmetric_eigen(Matrix S) {
  Matrix Q = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  bool turned = true;
  for (int sweep = 0; sweep < 40 && turned; ++sweep) {
    turned = false;
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        const Real off = S[3 * p + q];
        // Roundoff of a long double of 64 bits; what is left moves an eigenvalue by no more.
        if (std::abs(off) <= 0x1p-62L * (std::abs(S[4 * p]) + std::abs(S[4 * q]))) continue;
        turned = true;
        const Real h = S[4 * q] - S[4 * p], r = std::hypot(h, 2 * off);
        const Real t = (h >= 0 ? 1 : -1) * 2 * off / (std::abs(h) + r);
        const Real c = 1 / std::sqrt(1 + t * t), s = t * c;
        Matrix G = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        G[4 * p] = G[4 * q] = c, G[3 * p + q] = s, G[3 * q + p] = -s;
        S = multiply(transpose(G), multiply(S, G));
        Q = multiply(Q, G);
      }
  }
  return {{S[0], S[4], S[8]}, Q};
}

/// τ = 2μ(F − R)Fᵀ + λ(J−1)J I of F = I + D. For det F > 0 from (F − R)Fᵀ = Σ (e − (√(1+e) − 1)) n
/// nᵀ over the eigenpairs (e, n) of FFᵀ − I, which keeps small strains; otherwise from the polar
/// factor.
inline Matrix stress_oracle(const Matrix& D, Real mu, Real lambda) {
  const Real j = det_minus_one(D);
  Matrix G{};
  if (j > -1) {
    const Eigen3 e = symmetric_eigen(left_strain(D));
    for (int m = 0; m < 3; ++m) {
      const Real x = e.values[m], f = x - x / (1 + std::sqrt(1 + x));
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) G[3 * i + k] += f * e.vectors[3 * i + m] * e.vectors[3 * k + m];
    }
  } else {
    const Matrix F = plus_identity(D), R = polar_oracle(F);
    Matrix difference;
    for (int k = 0; k < 9; ++k) difference[k] = F[k] - R[k];
    G = multiply(difference, transpose(F));
  }
  for (int k = 0; k < 9; ++k) G[k] = 2 * mu * G[k] + (k % 4 == 0 ? lambda * j * (1 + j) : 0);
  return G;
}

/// A Fᵀ of the second derivative along δF = L F, from the definition: δR = R [ω]×, W S + S W =
/// RᵀδF − δFᵀR solved in the singular basis, and the cofactor matrix differentiated term by term.
inline Matrix hessian_oracle(const Matrix& F, const Matrix& L, Real mu, Real lambda) {
  const Svd usv = svd_oracle(F);
  const Matrix dF = multiply(L, F);
  // In the bases U, V: (UᵀδR V)_ij = (M − Mᵀ)_ij / (σ_i + σ_j) with M = UᵀδF V.
  const Matrix M = multiply(transpose(usv.U), multiply(dF, usv.V));
  Matrix W{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != j) W[3 * i + j] = (M[3 * i + j] - M[3 * j + i]) / (usv.sigma[i] + usv.sigma[j]);
  const Matrix dR = multiply(usv.U, multiply(W, transpose(usv.V)));
  const auto cofactor = [](const Matrix& A, const Matrix& B) {  // bilinear; cofactor(F, F) = cof F
    Matrix C;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int a = (i + 1) % 3, b = (i + 2) % 3, p = (j + 1) % 3, q = (j + 2) % 3;
        C[3 * i + j] = A[3 * a + p] * B[3 * b + q] - A[3 * a + q] * B[3 * b + p];
      }
    return C;
  };
  const Matrix C = cofactor(F, F), left = cofactor(dF, F), right = cofactor(F, dF);
  Real dJ = 0;
  for (int k = 0; k < 9; ++k) dJ += C[k] * dF[k];
  Matrix A;
  for (int k = 0; k < 9; ++k)
    A[k] = 2 * mu * (dF[k] - dR[k]) + lambda * dJ * C[k] +
           lambda * (det(F) - 1) * (left[k] + right[k]);
  return multiply(A, transpose(F));
}

/// Step 7 from its definition.
struct ReturnMapped {
  Matrix F_E, F_P;
  Svd trial;
};

inline ReturnMapped return_map_oracle(const Matrix& F_hat, const Matrix& F_P, Real lo, Real hi) {
  ReturnMapped r;
  r.trial = svd_oracle(F_hat);
  Matrix scaled = r.trial.U, ratio = r.trial.V;
  for (int j = 0; j < 3; ++j) {
    const Real s = r.trial.sigma[j], c = s > hi ? hi : s < lo ? lo : s;
    for (int i = 0; i < 3; ++i) scaled[3 * i + j] *= c, ratio[3 * i + j] *= s / c;
  }
  const Matrix Vt = transpose(r.trial.V);
  r.F_E = multiply(scaled, Vt);
  r.F_P = multiply(multiply(ratio, Vt), F_P);
  return r;
}

}  // namespace firn::verification
