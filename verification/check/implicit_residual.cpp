// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/implicit_residual.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace firn::check {

namespace {

Mat3 cofactor(const Mat3& F) {
  Mat3 C;
  for (int column = 0; column < 3; ++column)
    C.col(column) = F.col((column + 1) % 3).cross(F.col((column + 2) % 3));
  return C;
}

/// Derivative of the cofactor matrix along δF.
Mat3 cofactor_differential(const Mat3& F, const Mat3& dF) {
  Mat3 dC;
  for (int column = 0; column < 3; ++column) {
    const int a = (column + 1) % 3, b = (column + 2) % 3;
    dC.col(column) = dF.col(a).cross(F.col(b)) + F.col(a).cross(dF.col(b));
  }
  return dC;
}

/// F = R S with det R = +1.
struct Polar {
  Mat3 R, S;
};
Polar polar(const Mat3& F) {
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) = -U.col(2);
  const Mat3 R = U * svd.matrixV().transpose();
  return {R, R.transpose() * F};
}

/// δR = R W with the skew W that solves W S + S W = RᵀδF − δFᵀR: for the axial vectors
/// w of W and b of the right-hand side, (tr(S) I − S) w = b.
Mat3 rotation_differential(const Polar& polar, const Mat3& dF) {
  const Mat3 right = polar.R.transpose() * dF - dF.transpose() * polar.R;
  const Vec3 b(right(2, 1), right(0, 2), right(1, 0));
  const Mat3 K = polar.S.trace() * Mat3::Identity() - polar.S;
  const Vec3 w = K.fullPivLu().solve(b);
  Mat3 W;
  W << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return polar.R * W;
}

/// ∂²Ψ/∂F² : δF for Ψ = μ‖F − R‖² + ½λ(J − 1)².
Mat3 stress_differential(double mu, double lambda, const Mat3& F, const Mat3& dF) {
  const Mat3 C = cofactor(F);
  const double J = F.determinant();
  return 2 * mu * (dF - rotation_differential(polar(F), dF)) +
         lambda * C.cwiseProduct(dF).sum() * C + lambda * (J - 1) * cofactor_differential(F, dF);
}

}  // namespace

std::vector<Vec3> hessian(const Scene& scene, const Particles& p, const Stencils& stencils,
                          const std::vector<Vec3>& u) {
  std::vector<Vec3> Hu(u.size(), Vec3::Zero());
  std::vector<StencilNode> around;
  for (std::size_t q = 0; q < p.size(); ++q) {
    const Material& material = scene.materials[static_cast<std::size_t>(p.material[q])];
    const double hardening = std::exp(material.hardening * (1 - p.F_P[q].determinant()));
    stencils.around(q, around);
    Mat3 L = Mat3::Zero();
    for (const StencilNode& s : around)
      if (s.node >= 0) L += u[static_cast<std::size_t>(s.node)] * s.grad_w.transpose();
    const Mat3 V_A_FT =
        p.V_0[q] *
        stress_differential(hardening * material.mu_0(), hardening * material.lambda_0(), p.F_E[q],
                            L * p.F_E[q]) *
        p.F_E[q].transpose();
    for (const StencilNode& s : around)
      if (s.node >= 0) Hu[static_cast<std::size_t>(s.node)] += V_A_FT * s.grad_w;
  }
  return Hu;
}

ImplicitResidual implicit_residual(const Scene& scene, const State& state, const BoundModel& model,
                                   const std::vector<Vec3>& v_new, double dt) {
  const Grid& grid = state.grid;
  const ErrorBounds& bounds = model.bounds();
  const std::vector<Vec3> Hv = hessian(scene, state.particles, model.stencils(), v_new);
  const double beta_dt2 = scene.integrator.implicitness * dt * dt;
  // A node's change is a sum of search directions that may cancel there: each is as large as
  // the solve's largest change may make it, whatever is left of the sum at this node.
  double largest_change = 0;
  for (std::size_t i = 0; i < grid.size(); ++i)
    largest_change = std::max(largest_change, (v_new[i] - grid.v_star[i]).norm());
  ImplicitResidual result;
  double residual = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Mat3& free = grid.free_directions[i];
    // In doubt whether contact holds this node: whatever it does is right.
    if (bounds.free_directions[i] > 1) continue;
    const Vec3 r = free * (grid.v_star[i] - v_new[i] - beta_dt2 / grid.m[i] * Hv[i]);
    residual += grid.m[i] * r.squaredNorm();
    const Vec3 change = v_new[i] - grid.v_star[i];
    // Each direction is projected to within rounding of its size.
    const double held_bound =
        bounds.v_star[i] + bounds.free_directions[i] * change.norm() +
        Roundoff::few * model.roundoff().eps * (grid.v_star[i].norm() + largest_change);
    const double held = (change - free * change).norm();
    if (held > result.held_in_bounds * held_bound) {
      result.held_in_bounds = held / held_bound;
      result.held_node = i;
    }
  }
  result.residual = std::sqrt(residual);
  result.allowed = bounds.implicit_residual;
  return result;
}

}  // namespace firn::check
