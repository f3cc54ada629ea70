// SPDX-License-Identifier: BSD-3-Clause
#include "reference/svd.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace firn::reference {

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

/// Quadratic convergence needs 4 or 5 sweeps; 20 were never seen.
constexpr int max_sweeps = 20;

/// Turns columns p and q of B = A V, and of V with them, by the angle which
/// makes those of B orthogonal, the longer one first. Returns whether anything
/// was done.
///
/// With α = |b_p|², β = |b_q|², γ = b_p·b_q the angle obeys tan 2θ = 2γ/(α − β).
/// If α < β the columns are exchanged first (one with its sign turned, for
/// det V = 1); then θ in [−π/4, π/4] keeps the longer one first. An exchange
/// counts as a change: the next sweep has to look at all pairs again.
bool orthogonalize(Mat3& B, Mat3& V, int p, int q, double negligible) {
  double alpha = B.col(p).squaredNorm();
  double beta = B.col(q).squaredNorm();
  double gamma = B.col(p).dot(B.col(q));
  const bool exchange = alpha < beta;
  if (exchange) {
    for (Mat3* M : {&B, &V}) {
      M->col(p).swap(M->col(q));
      M->col(q) *= -1;
    }
    std::swap(alpha, beta);
    gamma = -gamma;
  }
  if (gamma * gamma <= eps * eps * alpha * beta || std::abs(gamma) <= negligible) return exchange;

  // cos θ = x/n, sin θ = y/n. Written with tan θ/2, a small turn adds a small
  // correction, so that the roundoff of many of them does not accumulate.
  const double d = alpha - beta;
  const double y = 2 * gamma;
  const double x = d + std::sqrt(d * d + y * y);
  const double n = std::sqrt(x * x + y * y);
  const double sine = y / n;
  const double tan_half = y / (n + x);
  for (Mat3* M : {&B, &V}) {
    const Vec3 m_p = M->col(p), m_q = M->col(q);
    M->col(p) += sine * (m_q - tan_half * m_p);
    M->col(q) -= sine * (m_p + tan_half * m_q);
  }
  return true;
}

/// Two unit vectors e, f which form a right-handed orthonormal basis (u, e, f)
/// with the unit vector u (Duff et al. 2017: no branch, accurate for every u).
void complete_basis(const Vec3& u, Vec3& e, Vec3& f) {
  const double sign = std::copysign(1.0, u[2]);
  const double a = -1 / (sign + u[2]);
  const double b = u[0] * u[1] * a;
  e = Vec3(1 + sign * u[0] * u[0] * a, sign * b, -sign * u[0]);
  f = Vec3(b, sign + u[1] * u[1] * a, -u[1]);
}

/// U and Σ from B = U Σ, whose columns are orthogonal and sorted by length.
/// Only u1 is a normalized column: u2 is sought in the plane normal to u1 and u3
/// follows from both, so that U is a rotation even where columns vanish.
void factor_orthogonal_columns(const Mat3& B, Mat3& U, Vec3& sigma) {
  sigma[0] = B.col(0).norm();
  const Vec3 u1 = sigma[0] > 0 ? Vec3(B.col(0) / sigma[0]) : Vec3(Vec3::UnitX());
  Vec3 e, f;
  complete_basis(u1, e, f);
  // The second column may be so short that its square underflows.
  double y = e.dot(B.col(1)), z = f.dot(B.col(1));
  const double larger = std::max(std::abs(y), std::abs(z));
  y = larger > 0 ? y / larger : 0;
  z = larger > 0 ? z / larger : 1;
  const double norm = std::sqrt(y * y + z * z);
  y /= norm;
  z /= norm;
  U.col(0) = u1;
  U.col(1) = y * e + z * f;
  U.col(2) = y * f - z * e;
  sigma[1] = std::min(larger * norm, sigma[0]);
  sigma[2] = std::clamp(U.col(2).dot(B.col(2)), -sigma[1], sigma[1]);
}

Svd not_a_number() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {Mat3::Constant(nan), Vec3::Constant(nan), Mat3::Constant(nan)};
}

}  // namespace

Svd svd(const Mat3& A) {
  Svd result;
  Mat3 B = A;
  double squared_size = A.squaredNorm();
  int exponent = 0;
  if (!(squared_size > 0x1p-200 && squared_size < 0x1p200)) {
    if (!A.allFinite()) return not_a_number();
    // Squares of squares must neither overflow nor underflow; powers of two scale without error.
    std::frexp(A.cwiseAbs().maxCoeff(), &exponent);
    B = A.unaryExpr([&](double a) { return std::ldexp(a, -exponent); });
    squared_size = B.squaredNorm();
  }
  // Columns shorter than about ε² σ1 are roundoff of σ1; no angle between them means anything.
  const double negligible = 0x1p-116 * squared_size;

  result.V.setIdentity();
  bool changed = true;
  for (int sweep = 0; changed && sweep < max_sweeps; ++sweep) {
    changed = orthogonalize(B, result.V, 0, 1, negligible);
    changed |= orthogonalize(B, result.V, 0, 2, negligible);
    changed |= orthogonalize(B, result.V, 1, 2, negligible);
  }
  factor_orthogonal_columns(B, result.U, result.sigma);
  if (exponent != 0)
    for (double& s : result.sigma) s = std::ldexp(s, exponent);
  return result;
}

}  // namespace firn::reference
