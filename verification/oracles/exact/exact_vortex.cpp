// SPDX-License-Identifier: BSD-3-Clause
/// The generalized vortex: large shears, known in closed form.

#include <cmath>

#include "verification/oracles/exact/exact_parts.hpp"

namespace firn::exact {

using namespace parts;

namespace {

/// The vortex at one radius and time: α and its derivatives.
struct Turn {
  double alpha = 0, rate = 0, acceleration = 0;  ///< α, α̇, α̈
  double alpha_R = 0, alpha_RR = 0;              ///< ∂α/∂R, ∂²α/∂R²
};

struct Vortex {
  double G, T;
  Vec3 centre;

  /// α = g(t) p(R), p = (1 − 4ρ²)², ρ = 2(R − 1): p and p' vanish at ρ = ±½, where the
  /// body at rest begins. g = G sin(πt/T).
  Turn turn(double R, double t) const {
    const double rho = 2 * (R - 1), q = 1 - 4 * rho * rho;
    if (q <= 0) return {};
    const double phase = M_PI / T * t, g = G * std::sin(phase);
    const double p = q * q, p_R = 2 * (-16 * rho * q), p_RR = 4 * (-16 * q + 128 * rho * rho);
    const double rate = M_PI / T;
    return {g * p, G * rate * std::cos(phase) * p, -rate * rate * g * p, g * p_R, g * p_RR};
  }
};

/// A point of the vortex in polar coordinates, with the basis e_r, e_θ of where it is at t.
struct Polar {
  double R = 0;
  Vec3 e_r = Vec3::UnitX(), e_theta = Vec3::UnitY();
};

Polar polar(const Vec3& from_centre, double turned) {
  Polar at;
  at.R = std::hypot(from_centre.x(), from_centre.y());
  const double angle = std::atan2(from_centre.y(), from_centre.x()) + turned;
  at.e_r = Vec3(std::cos(angle), std::sin(angle), 0);
  at.e_theta = Vec3(-std::sin(angle), std::cos(angle), 0);
  return at;
}

/// b = ẍ − div P/ρ_0. With x = R e_r(Θ + α): F = (e_r + γ e_θ)⊗E_R + e_θ⊗E_Θ + e_z⊗E_Z, a simple
/// shear γ = R α' seen from a basis turned by α. Its polar rotation turns by φ, tan φ = γ/2, so
/// with S = √(4+γ²), cos φ = 2/S, sin φ = γ/S and J = 1
///     P = 2μ(F − R) = (a e_r + d e_θ)⊗E_R + (b e_r + a e_θ)⊗E_Θ,
///     a = 2μ(1 − 2/S),  b = 2μ γ/S,  d = 2μ(γ − γ/S),
/// and, as ∂e_r/∂R = α' e_θ and ∂e_r/∂Θ = e_θ,
///     div P = ∂(P E_R)/∂R + P E_R/R + ∂(P E_Θ)/∂Θ/R
///           = (a' − d α') e_r + (d' + a α' + (d + b)/R) e_θ.
Vec3 vortex_force(const Vortex& vortex, const Material& snow, const Vec3& X, double t) {
  const Vec3 from_centre = X - vortex.centre;
  const double R = std::hypot(from_centre.x(), from_centre.y());
  const Turn turn = vortex.turn(R, t);
  const Polar at = polar(from_centre, turn.alpha);
  const double gamma = R * turn.alpha_R, gamma_R = turn.alpha_R + R * turn.alpha_RR;
  const double S = std::sqrt(4 + gamma * gamma), S3 = S * S * S, two_mu = 2 * snow.mu_0();
  const double a = two_mu * (1 - 2 / S), a_R = two_mu * 2 * gamma * gamma_R / S3;
  const double d = two_mu * gamma * (1 - 1 / S), d_R = two_mu * gamma_R * (1 - 4 / S3);
  const double d_plus_b = two_mu * gamma;
  const Vec3 acceleration = R * (turn.acceleration * at.e_theta - turn.rate * turn.rate * at.e_r);
  if (R == 0) return acceleration;
  return acceleration - ((a_R - d * turn.alpha_R) * at.e_r +
                         (d_R + a * turn.alpha_R + d_plus_b / R) * at.e_theta) /
                            snow.density;
}

}  // namespace

ExactProblem vortex(int cells, double cfl, const AlphaPolicy& policy, double G) {
  ExactProblem problem;
  problem.name = "vortex";
  const Material snow = elastic_material();
  constexpr double edge = 2.5;
  const double h = edge / cells, c = sound_speed(snow), T = 1 / c, end = 0.5 * T;
  problem.steps = static_cast<int>(std::ceil(end / (cfl * h / c)));
  const double dt = end / problem.steps;
  problem.scene = elastic_scene(problem.name, h, dt, policy.alpha(dt));
  problem.scene.grid.periodic = Vec3(edge, edge, 4 * h);
  fill(problem, cells, cells, 4);
  const Vortex motion{G, T, Vec3(0.5 * edge, 0.5 * edge, 0)};
  problem.displacement = [motion](const Vec3& X, double t) {
    const Vec3 from_centre = X - motion.centre;
    const double R = std::hypot(from_centre.x(), from_centre.y());
    const Polar before = polar(from_centre, 0), after = polar(from_centre, motion.turn(R, t).alpha);
    return Vec3(R * (after.e_r - before.e_r));
  };
  problem.body_force = [motion, snow](const Vec3& X, double t) {
    return vortex_force(motion, snow, X, t);
  };
  for (std::size_t p = 0; p < problem.X.size(); ++p) {
    const Polar at = polar(problem.X[p] - motion.centre, 0);
    problem.initial.particles.v[p] = at.R * motion.turn(at.R, 0).rate * at.e_theta;
  }
  return problem;
}

}  // namespace firn::exact
