// SPDX-License-Identifier: BSD-3-Clause
/// Error bounds of steps 1 to 4: what the particles give to the grid.

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "verification/check/bounds.hpp"
#include "verification/check/conditioning.hpp"

namespace firn::check {

namespace {

/// Of a node's mass: beyond this part, which rounding decides, nothing is made of its inverse.
constexpr double uncertain_part = 0.25;

double largest_speed(const std::vector<Vec3>& v) {
  double largest = 0;
  for (const Vec3& each : v) largest = std::max(largest, each.norm());
  return largest;
}

/// x_p as the weights see it: the state's own rounding, then (x − o)/h, three
/// roundings of size |t|, and the distance t − i, one of size 2, in each solver.
std::vector<Vec3> weight_argument_errors(const Scene& scene, const Particles& particles,
                                         const std::vector<Vec3>& x_error, double eps) {
  std::vector<Vec3> errors;
  errors.reserve(particles.size());
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Vec3 from_origin = (particles.x[p] - scene.grid.origin).cwiseAbs();
    errors.push_back(x_error[p] + eps * (3 * from_origin + Vec3::Constant(2 * scene.grid.spacing)));
  }
  return errors;
}

}  // namespace

/// m_i = Σ m_p w_ip: roundoff of a sum of positive terms, relative to m_i, and the
/// weights that the positions' error moves, relative to m_p.
///
/// v_i = Σ m_p w_ip v_p / m_i is a mean: equal changes of numerator and denominator
/// cancel, δv_i = Σ m_p δw_ip (v_p − v_i)/m_i, never more than the spread of the v_p.
/// A light node (2 − d ≪ 1) has |δw|/w ~ 3δ/(2 − d), as large as you like, but with
/// one particle in reach its velocity is still that particle's.
void BoundModel::rasterize(const State& before, const State& after) {
  const Particles& p = before.particles;
  const Grid& grid = after.grid;
  stencils_ =
      Stencils(scene_, p, grid, weight_argument_errors(scene_, p, bounds_.x, r_.eps), r_.tiny);
  std::vector<double> terms(grid.size()), mass_shift(grid.size()), speed(grid.size()),
      velocity_shift(grid.size()), spread(grid.size());
  std::vector<StencilNode> around;
  for (std::size_t q = 0; q < p.size(); ++q) {
    stencils_.around(q, around);
    for (const StencilNode& s : around) {
      if (s.node < 0) continue;
      const auto i = static_cast<std::size_t>(s.node);
      const double departure = (p.v[q] - grid.v[i]).norm();
      terms[i] += 1;
      mass_shift[i] += p.m[q] * s.w_error;
      speed[i] += p.m[q] * s.w * p.v[q].norm();
      velocity_shift[i] += p.m[q] * s.w_error * departure;
      spread[i] = std::max(spread[i], departure);
    }
  }
  bounds_.m_i.resize(grid.size());
  bounds_.v_i.resize(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double m = grid.m[i];
    bounds_.m_i[i] = r_.sum(Roundoff::node_mass, terms[i]) * m + mass_shift[i];
    bounds_.v_i[i] = r_.sum(Roundoff::node_velocity, terms[i]) * speed[i] / m +
                     std::min(velocity_shift[i] / m, spread[i]);
  }
  bounds_.uncertain_mass = bounds_.m_i;
  bounds_.node_cause.assign(grid.size(), {});
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (bounds_.m_i[i] > widest_judged * grid.m[i])
      bounds_.node_cause[i].kind = Cause::Kind::light_node;
  bounds_.node_cause.assign(grid.size(), {});
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (bounds_.m_i[i] > uncertain_part * grid.m[i])
      bounds_.node_cause[i].kind = Cause::Kind::light_node;
}

/// V_p0 = m_p/ρ_p0, ρ_p0 = Σ_i m_i w_ip / h³: positive terms, so relative errors are
/// means of the terms' relative errors.
void BoundModel::volumes(const State& before, const State& after) {
  const Particles& p = before.particles;
  const Grid& grid = after.grid;
  std::vector<StencilNode> around;
  for (std::size_t q = 0; q < p.size(); ++q) {
    if (before.particles.V_0[q] > 0) continue;
    stencils_.around(q, around);
    double sum = 0, error = 0;
    for (const StencilNode& s : around) {
      if (s.node < 0) continue;
      const auto i = static_cast<std::size_t>(s.node);
      sum += grid.m[i] * s.w;
      error += bounds_.m_i[i] * s.w + grid.m[i] * s.w_error;
    }
    bounds_.V_0[q] = after.particles.V_0[q] * (Roundoff::volume * r_.eps + error / sum);
  }
}

/// f_i = −Σ V_p0 τ_p ∇w_ip with τ_p = P_p F_E^T (conditioning.hpp).
void BoundModel::grid_forces(const State& before, const State& after) {
  const Particles& p = before.particles;
  const Grid& grid = after.grid;
  std::vector<double> terms(grid.size()), size(grid.size()), error(grid.size());
  std::vector<StencilNode> around;
  for (std::size_t q = 0; q < p.size(); ++q) {
    const Material& material = scene_.materials[static_cast<std::size_t>(p.material[q])];
    const Sized tau =
        kirchhoff_stress(material, p.F_E[q], p.F_P[q], bounds_.F_E[q], bounds_.F_P[q], r_.eps);
    const double V = p.V_0[q], V_error = bounds_.V_0[q];
    stencils_.around(q, around);
    for (const StencilNode& s : around) {
      if (s.node < 0) continue;
      const auto i = static_cast<std::size_t>(s.node);
      const double g = s.grad_w.norm();
      terms[i] += 1;
      size[i] += V * tau.size * g;
      error[i] += V * (tau.error * g + tau.size * s.grad_w_error) + V_error * tau.size * g;
    }
  }
  bounds_.f.resize(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i)
    bounds_.f[i] = r_.sum(Roundoff::node_mass, terms[i]) * size[i] + error[i] + r_.tiny;
}

/// v_i* = v_i + Δt (f_i/m_i + g). A node whose mass is itself uncertain has an
/// uncertain v_i*, but not an unlimited one: mass and force come from the same
/// weights, so that v_i* is off by its own size at most, or missing altogether.
void BoundModel::grid_velocities(const State& before, const State& after, double dt) {
  const Grid& grid = after.grid;
  const double v_max = largest_speed(before.particles.v);
  bounds_.v_star.resize(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double m = grid.m[i], f = grid.f[i].norm(), v = grid.v[i].norm();
    const double m_error = bounds_.m_i[i] / m;
    const double local = Roundoff::few * r_.eps * (v + dt * f / m + dt * scene_.gravity.norm());
    if (m_error > uncertain_part) {
      bounds_.v_star[i] = 2 * (grid.v_star[i].norm() + v_max) + local;
      continue;
    }
    // 1/(m − δm) ≤ (1 + m_error/(1 − m_error))/m
    bounds_.v_star[i] =
        bounds_.v_i[i] + dt * (bounds_.f[i] + f * m_error) / (m * (1 - m_error)) + local;
  }
}

}  // namespace firn::check
