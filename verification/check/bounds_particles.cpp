// SPDX-License-Identifier: BSD-3-Clause
/// Error bounds of steps 7, 8 and 10: what the grid gives back to the particles.

#include <algorithm>
#include <cmath>

#include "verification/check/bounds.hpp"
#include "verification/check/conditioning.hpp"

namespace firn::check {

/// ∇v_p = Σ v_i (∇w_ip)^T, F̂_E = (I + Δt ∇v_p) F_E, then the plastic return. A solver may
/// keep F̂_E − I, with the rounding of that.
void BoundModel::deformation(const State& before, double dt) {
  const Particles& p = before.particles;
  const Grid& grid = before.grid;
  std::vector<StencilNode> around;
  for (std::size_t q = 0; q < p.size(); ++q) {
    stencils_.around(q, around);
    Vec3 mean = Vec3::Zero();
    Mat3 L = Mat3::Zero();
    for (const StencilNode& s : around) {
      if (s.node < 0) continue;
      const Vec3& v = grid.v_new[static_cast<std::size_t>(s.node)];
      mean += s.w * v;
      L += v * s.grad_w.transpose();
    }
    double L_error = 0, widest = 0;
    for (const StencilNode& s : around) {
      if (s.node < 0) continue;
      const auto i = static_cast<std::size_t>(s.node);
      const double g = s.grad_w.norm();
      // Roundoff of each ∇w_ip is its own and meets the full |v_i|; an error of the
      // position changes all of them together with Σ δ∇w_ip = 0, so that only
      // differences of velocity count.
      const double from_node = bounds_.v_new[i] * (g + s.grad_w_error);
      if (from_node > widest && bounds_.node_cause[i] != Cause{})
        bounds_.particle_cause[q] = bounds_.node_cause[i];
      widest = std::max(widest, from_node);
      L_error += from_node + Roundoff::velocity_gradient * r_.eps * grid.v_new[i].norm() * g +
                 (grid.v_new[i] - mean).norm() * s.grad_w_error;
    }
    const Mat3 growth = Mat3::Identity() + dt * L;
    const double F = p.F_E[q].norm();
    const Mat3 F_hat = growth * p.F_E[q];
    const double size = std::max(growth.norm() * F, (F_hat - Mat3::Identity()).norm());
    const double F_hat_error =
        dt * L_error * F + growth.norm() * bounds_.F_E[q] + Roundoff::few * r_.eps * size;
    const ReturnErrors errors =
        plastic_return(scene_.materials[static_cast<std::size_t>(p.material[q])], F_hat,
                       F_hat_error, p.F_P[q], bounds_.F_P[q], r_.eps);
    bounds_.F_E[q] = errors.F_E;
    bounds_.F_P[q] = errors.F_P;
    if (bounds_.particle_cause[q].kind == Cause::Kind::rounding && errors.condition > 1e3)
      bounds_.particle_cause[q].kind = Cause::Kind::singular;
  }
}

/// v_p = Σ w_ip v_i^{n+1} + α (v_p − Σ w_ip v_iⁿ), the blend of PIC and FLIP sorted
/// by what is exact: both sums are means with Σ δw_ip = 0.
void BoundModel::particle_velocities(const State& after_integration) {
  const Particles& p = after_integration.particles;
  const Grid& grid = after_integration.grid;
  const double alpha = scene_.flip;
  std::vector<StencilNode> around;
  for (std::size_t q = 0; q < p.size(); ++q) {
    stencils_.around(q, around);
    Vec3 mean_new = Vec3::Zero(), mean_old = Vec3::Zero();
    for (const StencilNode& s : around) {
      if (s.node < 0) continue;
      const auto i = static_cast<std::size_t>(s.node);
      mean_new += s.w * grid.v_new[i];
      mean_old += s.w * grid.v[i];
    }
    double size = alpha * p.v[q].norm(), error = alpha * bounds_.v[q], widest = 0;
    for (const StencilNode& s : around) {
      if (s.node < 0) continue;
      const auto i = static_cast<std::size_t>(s.node);
      size += s.w * (grid.v_new[i].norm() + alpha * grid.v[i].norm());
      const double from_node = (s.w + s.w_error) * (bounds_.v_new[i] + alpha * bounds_.v_i[i]);
      if (from_node > widest && bounds_.node_cause[i] != Cause{})
        bounds_.particle_cause[q] = bounds_.node_cause[i];
      widest = std::max(widest, from_node);
      error += from_node + s.w_error * ((grid.v_new[i] - mean_new).norm() +
                                        alpha * (grid.v[i] - mean_old).norm());
    }
    bounds_.v[q] = error + Roundoff::particle_velocity * r_.eps * size;
  }
}

/// x_p = x_p + Δt v_p: a product and a sum, beside the conversions that load() counts.
void BoundModel::positions(const State& before, const State& after, double dt) {
  const Particles& p = before.particles;
  for (std::size_t q = 0; q < p.size(); ++q) {
    const Vec3 moved = dt * p.v[q].cwiseAbs();
    bounds_.x[q] += Vec3::Constant(dt * bounds_.v[q]) +
                    r_.eps * (position_scale(scene_, after.particles.x[q]) + 2 * moved);
  }
}

}  // namespace firn::check
