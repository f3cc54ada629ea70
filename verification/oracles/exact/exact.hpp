// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Motions of an elastic body that are known in closed form, as scenes with a
/// resolution. The uniaxial response of the fixed corotated energy is exactly
/// linear, P11 = (λ+2μ)(F−1), so that the bar and the column hold at finite strain.

#include <functional>
#include <string>
#include <vector>

#include "firn/scene.hpp"

namespace firn::exact {

/// How the FLIP fraction α is chosen. PIC damps per step, with the numerical
/// viscosity (1−α)h²/(3Δt): a convergence plot means nothing without its policy.
struct AlphaPolicy {
  std::string name;  ///< "1", "0.95", "rate"
  double value = 1;  ///< fixed α
  /// "rate": 1 − α = Δt/τ, the damping h²/(3τ) vanishes with h² and does not know Δt.
  bool per_time = false;

  double alpha(double dt) const;
};

/// τ of the policy "rate" as a fraction of the wave's period: α = 0.95 at 16 cells, CFL 0.4.
inline constexpr double damping_time_share = 0.5;

struct ExactProblem {
  std::string name;
  Scene scene;
  State initial;
  int steps = 0;        ///< to the time at which the error is taken
  std::vector<Vec3> X;  ///< material points, in the order of the particles
  std::function<Vec3(const Vec3& X, double t)> displacement;  ///< u(X, t) [m]
  /// b(X, t) [m/s²]; empty: none.
  std::function<Vec3(const Vec3& X, double t)> body_force;

  /// Before a step from `state`: adds to v_p what the body force gives in Δt, by way of the
  /// grid as MPM does it, v_p += Δt Σ_i w_ip f_i/m_i with f_i = Σ_p m_p b_p w_ip. The
  /// elastic forces reach the particles on the same way and are weakened by the same
  /// factor; b_p itself on v_p would leave the balance of the two off by that factor.
  void push(State& state) const;

  /// ‖u_h − u‖ / ‖u‖ over the particles of `state`, the shortest way around periodic axes.
  double relative_error(const State& state) const;
};

/// u = A sin 2πX sin 2πct along x in a periodic bar of 1 m, taken after 1⅛ periods:
/// at a quarter period, where u is largest, an error of the phase would show in second order only.
ExactProblem standing_wave(int cells, double cfl, const AlphaPolicy& policy);

/// u_i = A sin ωt sin 2πX_i in the periodic unit cube with the body force that it
/// takes: b_i = ü_i − (2μ + λq²) ∂²u_i/∂X_i² / ρ, q the product of the other two F_j.
ExactProblem manufactured(int cells, double cfl, const AlphaPolicy& policy);

/// A column of 1 m under its own weight, at rest: F = 1 − ρg(H−X)/(λ+2μ). Starts from
/// that state and settles into the discrete equilibrium with α = 0.
ExactProblem column(int cells, double cfl, const AlphaPolicy& policy);

/// Generalized vortex (Kamojjala et al., Engineering with Computers 31, 2015): the ring
/// ¾ m ≤ R ≤ 1¼ m of a body at rest turns by α(R,t) = G sin(πt/T) (1 − 4ρ²)², ρ = (R − 1 m)/½ m,
/// and shears by γ = R ∂α/∂R on the way; J = 1. A period of 2½ m in x and y, plane strain in z,
/// T = 1 m/c, taken at ½T. With γ up to 7 G no linear theory holds. The body force for the
/// fixed corotated energy is derived at vortex_force() in exact.cpp.
ExactProblem vortex(int cells, double cfl, const AlphaPolicy& policy, double G = 0.15);

}  // namespace firn::exact
