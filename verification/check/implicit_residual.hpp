// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Does v_i^{n+1} solve the semi-implicit system? The one thing that the method
/// promises of an iterative solve, whatever the solver, and the only thing that can be
/// said where the system is indefinite.

#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "verification/check/bounds.hpp"

namespace firn::check {

/// (H u)_i = Σ_p V_p0 A_p F_Eᵀ ∇w_ip, A_p = ∂²Ψ/∂F_E² : (Σ_j u_j (∇w_jp)ᵀ) F_E. For a
/// velocity u at the nodes of `stencils` in m/s the result is in N/s. Written from the
/// energy with Eigen's SVD: shares no code with any solver.
std::vector<Vec3> hessian(const Scene& scene, const Particles& particles, const Stencils& stencils,
                          const std::vector<Vec3>& u);

struct ImplicitResidual {
  double residual = 0;        ///< ‖P(v* − v − βΔt² M⁻¹H v)‖_M, P = free directions
  double allowed = 0;         ///< tol ‖v*‖_M and the roundoff of v*, v and H
  double held_in_bounds = 0;  ///< largest ‖(I − P)(v_i − v_i*)‖: contact moved by the solve,
  std::size_t held_node = 0;  ///< in units of the roundoff of v_i*, and where
};

/// For the system that `state` (before or after stage 6) defines and the velocities
/// v_new at its nodes, whose inputs are known to `bounds`. Written anew from the
/// energy's second derivative, with Eigen's SVD: shares no code with any solver.
ImplicitResidual implicit_residual(const Scene& scene, const State& state, const BoundModel& model,
                                   const std::vector<Vec3>& v_new, double dt);

}  // namespace firn::check
