// SPDX-License-Identifier: BSD-3-Clause
#include "reference/minres.hpp"

#include <cmath>

namespace firn::reference {

double inner_product(const std::vector<double>& m, const NodeField& a, const NodeField& b) {
  double sum = 0;
  for (std::size_t i = 0; i < m.size(); ++i) sum += m[i] * a[i].dot(b[i]);
  return sum;
}

void add_scaled(double s, const NodeField& x, NodeField& y) {
  for (std::size_t i = 0; i < x.size(); ++i) y[i] += s * x[i];
}

namespace {

void scale(double s, NodeField& x) {
  for (Vec3& x_i : x) x_i *= s;
}

}  // namespace

/// The Lanczos process makes an orthonormal basis q_1, q_2, … of the Krylov space
/// in which B is tridiagonal:
///
///     B q_k = β_k q_{k−1} + α_k q_k + β_{k+1} q_{k+1}.
///
/// A Givens rotation (c, s) per iteration makes that matrix triangular, with
/// entries ρ1 (diagonal), ρ2 and ρ3 in each column. Then d is the sum of
/// directions w_k, each of which follows from q_k and the last two.
MinresResult minres(const std::function<NodeField(const NodeField&)>& B,
                    const std::vector<double>& m, const NodeField& r, double target,
                    std::int64_t max_iterations, NodeField& x) {
  const NodeField zero(r.size(), Vec3::Zero());
  NodeField q_last = zero, q = r, w_last = zero, w = zero;
  double beta = std::sqrt(inner_product(m, r, r));
  double residual = beta;  // with a sign; its size is the residual norm
  if (!(beta > 0)) return {};
  scale(1 / beta, q);
  beta = 0;  // q_0 = 0
  double c_last = 1, c = 1, s_last = 0, s = 0;
  double pivot = 1;  // of the tridiagonal matrix: all positive if it is positive definite

  MinresResult result;
  while (std::abs(residual) > target && result.iterations < max_iterations) {
    ++result.iterations;
    NodeField q_next = B(q);
    const double alpha = inner_product(m, q, q_next);
    add_scaled(-alpha, q, q_next);
    add_scaled(-beta, q_last, q_next);
    const double beta_next = std::sqrt(inner_product(m, q_next, q_next));
    pivot = alpha - (result.iterations > 1 ? beta * beta / pivot : 0);
    if (pivot <= 0) result.indefinite = true;

    const double rho_3 = s_last * beta;
    const double rho_2 = s * alpha + c_last * c * beta;
    const double delta = c * alpha - c_last * s * beta;
    const double rho_1 = std::sqrt(delta * delta + beta_next * beta_next);
    if (!(rho_1 > 0)) break;  // B is singular on this space (or not finite): no better d in it
    c_last = c;
    s_last = s;
    c = delta / rho_1;
    s = beta_next / rho_1;

    NodeField w_next = q;
    add_scaled(-rho_3, w_last, w_next);
    add_scaled(-rho_2, w, w_next);
    scale(1 / rho_1, w_next);
    add_scaled(c * residual, w_next, x);
    residual *= -s;

    w_last.swap(w);
    w.swap(w_next);
    if (!(beta_next > 0)) break;  // the Krylov space is exhausted: d is exact
    scale(1 / beta_next, q_next);
    q_last.swap(q);
    q.swap(q_next);
    beta = beta_next;
  }
  return result;
}

}  // namespace firn::reference
