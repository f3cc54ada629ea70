// SPDX-License-Identifier: BSD-3-Clause
/// Error bounds of step 6.

#include <cmath>
#include <optional>

#include "verification/check/bounds.hpp"
#include "verification/check/conditioning.hpp"

namespace firn::check {

/// Explicit: v_i^{n+1} = v_i*.
///
/// Semi-implicit: B v = v* with B = I + βΔt² M⁻¹H. Two solutions differ by B⁻¹ times the
/// difference of what they leave undone. As long as H is positive, B⁻¹ contracts in the
/// mass norm ‖a‖_M = (Σ m_i|a_i|²)^½, so that
///
///     ‖δv‖_M ≤ ‖δv*‖_M + 2 tol ‖v*‖_M + βΔt² ‖δH v‖_{M⁻¹}
///
/// (each solver stops at the relative residual that the scene states; δH is the roundoff
/// of the operator), and a single node can be off by ‖δv‖_M/√m_i. Where the reference met
/// negative curvature B⁻¹ has no such bound, and neither has v. Nor has it where a node's
/// contact is in doubt: B acts on other directions there.
void BoundModel::integration(const State& before, const State& after, double dt, bool indefinite) {
  const Grid& grid = after.grid;
  bounds_.v_new.resize(grid.size());
  double mass_norm = 0;
  std::optional<Cause> no_bound;
  if (indefinite) no_bound = Cause{Cause::Kind::indefinite};
  if (scene_.semi_implicit() && scene_.integrator.implicitness > 0)
    for (std::size_t i = 0; i < grid.size() && !no_bound; ++i)
      if (bounds_.free_directions[i] > 1) no_bound = bounds_.node_cause[i];
  if (scene_.semi_implicit()) {
    const double beta = scene_.integrator.implicitness, tolerance = scene_.integrator.tolerance;
    double v_star = 0, v_star_error = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      v_star += grid.m[i] * grid.v_star[i].squaredNorm();
      v_star_error += grid.m[i] * bounds_.v_star[i] * bounds_.v_star[i];
    }
    bounds_.implicit_residual = (tolerance + r_.eps) * std::sqrt(v_star) + std::sqrt(v_star_error) +
                                beta * dt * dt * stiffness_roundoff(before, grid);
    // β = 0 leaves nothing to solve. Otherwise the reference has a residual, too.
    if (beta > 0) mass_norm = bounds_.implicit_residual + tolerance * std::sqrt(v_star);
  }
  for (std::size_t i = 0; i < grid.size(); ++i) {
    bounds_.v_new[i] =
        bounds_.v_star[i] + r_.eps * grid.v_new[i].norm() + mass_norm / std::sqrt(grid.m[i]);
    if (mass_norm / std::sqrt(grid.m[i]) > bounds_.v_star[i] && bounds_.node_cause[i] == Cause{})
      bounds_.node_cause[i].kind = Cause::Kind::solve;
    if (!no_bound) continue;
    bounds_.v_new[i] = unbounded;
    bounds_.node_cause[i] = *no_bound;
  }
}

/// ‖δH v‖_{M⁻¹} for (H v)_i = Σ_p V_p0 A_p F_E^T ∇w_ip: A_p is linear in ∇v_p, which
/// carries the roundoff of its own sum, and its coefficients 2μ(1 + δR/δF) and
/// λ(J² + |J−1|J) carry that of the stress.
double BoundModel::stiffness_roundoff(const State& before, const Grid& grid) const {
  const Particles& p = before.particles;
  std::vector<double> error(grid.size());
  std::vector<StencilNode> around;
  for (std::size_t q = 0; q < p.size(); ++q) {
    const Material& material = scene_.materials[static_cast<std::size_t>(p.material[q])];
    const double stiffness = spatial_stiffness(material, p.F_E[q], p.F_P[q]);
    stencils_.around(q, around);
    Mat3 L = Mat3::Zero();
    double L_error = 0;
    for (const StencilNode& s : around) {
      if (s.node < 0) continue;
      const Vec3& v = grid.v_new[static_cast<std::size_t>(s.node)];
      L += v * s.grad_w.transpose();
      L_error +=
          v.norm() * (Roundoff::velocity_gradient * r_.eps * s.grad_w.norm() + s.grad_w_error);
    }
    const double tau_error =
        p.V_0[q] * stiffness * (Roundoff::stress * r_.eps * L.norm() + L_error);
    for (const StencilNode& s : around)
      if (s.node >= 0) error[static_cast<std::size_t>(s.node)] += tau_error * s.grad_w.norm();
  }
  double squares = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) squares += error[i] * error[i] / grid.m[i];
  return std::sqrt(squares);
}

}  // namespace firn::check
