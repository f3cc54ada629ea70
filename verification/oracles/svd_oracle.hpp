// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A plain singular value decomposition in long double, and the errors of somebody
/// else's decomposition measured against it. It judges kernels in float and double:
/// its own error is below 1/200 of an eps of double.

#include <algorithm>
#include <array>
#include <cmath>

namespace firn::verification {

using Real = long double;
using Matrix = std::array<Real, 9>;  ///< row-major

struct Svd {
  Matrix U;
  std::array<Real, 3> sigma;  ///< σ1 ≥ σ2 ≥ |σ3|, the sign of det A on σ3
  Matrix V;
};

inline Real det(const Matrix& A) {
  return A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) +
         A[2] * (A[3] * A[7] - A[4] * A[6]);
}

inline Matrix multiply(const Matrix& A, const Matrix& B) {
  Matrix C{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) C[3 * i + j] += A[3 * i + k] * B[3 * k + j];
  return C;
}

inline Matrix transpose(const Matrix& A) {
  return {A[0], A[3], A[6], A[1], A[4], A[7], A[2], A[5], A[8]};
}

inline Real norm(const Matrix& A) {
  Real s = 0;
  for (Real a : A) s += a * a;
  return std::sqrt(s);
}

namespace oracle_detail {

/// Columns count as orthogonal when the cosine of their angle is below this. The roundoff of a
/// cosine itself is up to 3e-19 (x86's long double, 64 bits): with less, noise would be rotated
/// without end.
inline constexpr Real orthogonal_cosine = 5e-19L;

/// Rotates columns p, q of B (and of V with them) until they are orthogonal and
/// |b_p| ≥ |b_q|. Returns whether anything changed: an exchange counts.
inline bool orthogonalize(Matrix& B, Matrix& V, int p, int q) {
  Real pp = 0, qq = 0, pq = 0;
  for (int i = 0; i < 3; ++i) {
    pp += B[3 * i + p] * B[3 * i + p];
    qq += B[3 * i + q] * B[3 * i + q];
    pq += B[3 * i + p] * B[3 * i + q];
  }
  Real c, s;
  if (std::abs(pq) <= orthogonal_cosine * std::sqrt(pp) * std::sqrt(qq)) {
    if (pp >= qq) return false;
    c = 0, s = 1;
  } else {
    // The eigenvector of [[pp, pq], [pq, qq]] with the larger eigenvalue, (cos θ, sin θ).
    const Real h = pp - qq, r = std::hypot(h, 2 * pq);
    c = h >= 0 ? h + r : 2 * std::abs(pq);
    s = h >= 0 ? 2 * pq : std::copysign(r - h, pq);
    const Real length = std::hypot(c, s);
    c /= length, s /= length;
  }
  for (Matrix* M : {&B, &V})
    for (int i = 0; i < 3; ++i) {
      const Real x = (*M)[3 * i + p], y = (*M)[3 * i + q];
      (*M)[3 * i + p] = c * x + s * y;
      (*M)[3 * i + q] = c * y - s * x;
    }
  return true;
}

/// A unit vector orthogonal to the unit vector n.
inline std::array<Real, 3> orthogonal(const std::array<Real, 3>& n) {
  int k = 0;  // the smallest component: its axis is far from n
  for (int i = 1; i < 3; ++i)
    if (std::abs(n[i]) < std::abs(n[k])) k = i;
  std::array<Real, 3> e{};
  for (int i = 0; i < 3; ++i) e[i] = (i == k ? 1 : 0) - n[k] * n[i];
  const Real length = std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
  for (Real& x : e) x /= length;
  return e;
}

}  // namespace oracle_detail

/// One-sided Jacobi (Hestenes 1958): A V = B with orthogonal columns, σ_j = |b_j|.
inline Svd svd_oracle(const Matrix& A) {
  Svd r;
  Real largest = 0;
  for (Real a : A) largest = std::max(largest, std::abs(a));
  int exponent = 0;
  if (largest > 0) std::frexp(largest, &exponent);
  Matrix B;
  for (int k = 0; k < 9; ++k) B[k] = std::ldexp(A[k], -exponent);
  r.V = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (int sweep = 0; sweep < 60; ++sweep) {
    const bool a = oracle_detail::orthogonalize(B, r.V, 0, 1);
    const bool b = oracle_detail::orthogonalize(B, r.V, 0, 2);
    const bool c = oracle_detail::orthogonalize(B, r.V, 1, 2);
    if (!a && !b && !c) break;
  }
  std::array<std::array<Real, 3>, 3> u{};
  Real size[3];
  for (int j = 0; j < 3; ++j) {
    size[j] = std::sqrt(B[j] * B[j] + B[3 + j] * B[3 + j] + B[6 + j] * B[6 + j]);
    for (int i = 0; i < 3; ++i) u[j][i] = size[j] > 0 ? B[3 * i + j] / size[j] : 0;
  }
  // Columns that vanish against σ1 carry no direction: complete the basis.
  if (!(size[0] > 0)) u[0] = {1, 0, 0};
  if (!(size[1] > 1e-25L * size[0])) u[1] = oracle_detail::orthogonal(u[0]);
  const std::array<Real, 3> cross = {u[0][1] * u[1][2] - u[0][2] * u[1][1],
                                     u[0][2] * u[1][0] - u[0][0] * u[1][2],
                                     u[0][0] * u[1][1] - u[0][1] * u[1][0]};
  // det U = +1 by construction; the projection of b3 on u3 carries the sign.
  Real s3 = 0;
  for (int i = 0; i < 3; ++i) s3 += cross[i] * B[3 * i + 2];
  u[2] = cross;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r.U[3 * i + j] = u[j][i];
  r.sigma = {std::ldexp(size[0], exponent), std::ldexp(size[1], exponent),
             std::ldexp(std::copysign(size[2], s3), exponent)};
  return r;
}

/// R = U Vᵀ of the oracle: det R = +1.
inline Matrix polar_oracle(const Matrix& A) {
  const Svd r = svd_oracle(A);
  return multiply(r.U, transpose(r.V));
}

/// ‖QᵀQ − I‖
inline Real orthogonality_error(const Matrix& Q) {
  Matrix E = multiply(transpose(Q), Q);
  E[0] -= 1, E[4] -= 1, E[8] -= 1;
  return norm(E);
}

/// How wrong a decomposition A = U diag(σ) Vᵀ is, in units of `eps` of the type that computed it.
struct SvdErrors {
  Real backward;         ///< ‖UΣVᵀ − A‖ / ‖A‖
  Real orthogonality_U;  ///< ‖UᵀU − I‖
  Real orthogonality_V;  ///< ‖VᵀV − I‖
  Real sigma;            ///< max |σ_i − σ_i exact| / σ1
  bool rotations;        ///< det U > 0 and det V > 0
  bool ordered;          ///< σ1 ≥ σ2 ≥ |σ3|
  bool sign;             ///< σ3 has the sign of det A wherever |σ3| > 8 eps σ1
  bool finite;
};

/// `grain`: the spacing of denormal numbers of the type. Each σ is rounded to it, so up to
/// 2 grain of the residual and 1 grain of each σ are no fault of the algorithm.
inline SvdErrors svd_errors(const Matrix& A, const Svd& computed, const Svd& exact, Real eps,
                            Real grain) {
  SvdErrors e{};
  e.finite = true;
  for (int k = 0; k < 9; ++k)
    e.finite = e.finite && std::isfinite(computed.U[k]) && std::isfinite(computed.V[k]);
  for (Real s : computed.sigma) e.finite = e.finite && std::isfinite(s);
  const auto& s = computed.sigma;
  Matrix scaled = computed.U;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) scaled[3 * i + j] *= s[j];
  Matrix residual = multiply(scaled, transpose(computed.V));
  for (int k = 0; k < 9; ++k) residual[k] -= A[k];
  const Real size = norm(A), off = std::max(norm(residual) - 2 * grain, Real(0));
  e.backward = (size > 0 ? off / size : norm(residual)) / eps;
  e.orthogonality_U = orthogonality_error(computed.U) / eps;
  e.orthogonality_V = orthogonality_error(computed.V) / eps;
  Real worst = 0;
  for (int j = 0; j < 3; ++j) worst = std::max(worst, std::abs(s[j] - exact.sigma[j]));
  // A σ3 of either sign within roundoff of zero: compare the absolute values there.
  if (std::abs(exact.sigma[2]) <= 8 * eps * exact.sigma[0])
    worst = std::max({std::abs(s[0] - exact.sigma[0]), std::abs(s[1] - exact.sigma[1]),
                      std::abs(std::abs(s[2]) - std::abs(exact.sigma[2]))});
  worst = std::max(worst - grain, Real(0));
  e.sigma = (exact.sigma[0] > 0 ? worst / exact.sigma[0] : worst) / eps;
  e.rotations = det(computed.U) > 0 && det(computed.V) > 0;
  e.ordered = s[0] >= s[1] && s[1] >= std::abs(s[2]);
  e.sign = std::abs(exact.sigma[2]) <= 8 * eps * exact.sigma[0] + grain ||
           std::signbit(s[2]) == std::signbit(exact.sigma[2]);
  return e;
}

}  // namespace firn::verification
