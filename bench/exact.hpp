#pragma once
/// Motions of an elastic body that are known in closed form, as scenes with a
/// resolution. The uniaxial response of the fixed corotated energy is exactly
/// linear, P11 = (λ+2μ)(F−1), so that the bar and the column hold at finite strain.

#include <functional>
#include <string>
#include <vector>

#include "firn/scene.hpp"

namespace firn::bench {

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
  /// b(X, t) [m/s²], added to v_p as Δt b before each step; empty: none.
  std::function<Vec3(const Vec3& X, double t)> body_force;

  /// ‖u_h − u‖ / ‖u‖ over the particles of `state`, the shortest way around periodic axes.
  double relative_error(const State& state) const;
};

/// u = A sin 2πX sin 2πct along x in a periodic bar of 1 m, taken after 1¼ periods.
ExactProblem standing_wave(int cells, double cfl, const AlphaPolicy& policy);

/// u_i = A sin ωt sin 2πX_i in the periodic unit cube with the body force that it
/// takes: b_i = ü_i − (2μ + λq²) ∂²u_i/∂X_i² / ρ, q the product of the other two F_j.
ExactProblem manufactured(int cells, double cfl, const AlphaPolicy& policy);

/// A column of 1 m under its own weight, at rest: F = 1 − ρg(H−X)/(λ+2μ). Starts from
/// that state and settles into the discrete equilibrium with α = 0.
ExactProblem column(int cells, double cfl, const AlphaPolicy& policy);

}  // namespace firn::bench
