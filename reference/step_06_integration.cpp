// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>

#include "reference/failure.hpp"
#include "reference/implicit_system.hpp"
#include "reference/steps.hpp"

namespace firn::reference {

namespace {

/// Semi-implicit update (Stomakhin et al. 2013, section 6 and appendix).
///
/// **The equation.** Let the nodes move for a moment, x̂_i = x_i + Δt u_i, and the
/// particles' F̂_E with them. The elastic energy
///
///     Φ(x̂) = Σ_p V_p0 Ψ(F̂_Ep(x̂), F_Pp),   F̂_Ep(x̂) = (I + Σ_i (x̂_i − x_i)(∇w_ip)ᵀ) F_Ep
///
/// has the forces f_i = −∂Φ/∂x̂_i. The velocity shall change by the fraction β of
/// the force at the end of the step and 1 − β of that at its beginning. With the
/// force at the end linearized, f^{n+1} ≈ f^n − Δt H v^{n+1}, H = ∂²Φ/∂x̂∂x̂, this is
///
///     v_i^{n+1} + βΔt²/m_i Σ_j H_ij v_j^{n+1} = v_i*,   in short   B v = v*.
///
/// **H without a matrix.** A field u changes F̂_Ep at the rate δF_p = (Σ_j u_j (∇w_jp)ᵀ) F_Ep.
/// The chain rule, once for each index of H, gives
///
///     (H u)_i = Σ_p V_p0 A_p F_Epᵀ ∇w_ip,   A_p = ∂²Ψ/∂F_E² : δF_p.
///
/// **A_p.** With P = 2μ(F − R) + λ(J − 1)C, C = cof F = ∂J/∂F, term by term
///
///     A = 2μ(δF − δR) + λ(C : δF) C + λ(J − 1) δC.
///
/// δC is linear in F, so no inverse of F is taken; δR = R W, where the skew W
/// solves W S + S W = RᵀδF − δFᵀR: three equations in three unknowns
/// (constitutive.cpp). Nothing is dropped, the derivative is exact.
///
/// **Contact.** The collisions of step 5 have decided v* at the nodes in contact.
/// The solve may change v only along the directions that they leave free,
/// v = v* + P d with the projector P of each node: otherwise it would push nodes
/// back into the collider. The system becomes P B P d = P(v* − B v*).
///
/// **Solving it.** M B = M + βΔt²H is symmetric, that is, B is self-adjoint in
/// the inner product (a, b) = Σ m_i a_i·b_i. It need not be positive: in
/// compression the energy has directions of negative curvature. MINRES asks for
/// symmetry only. Its first residual P(v* − B v*) = −βΔt² P M⁻¹H v* carries no
/// momentum where nothing is held, since Σ_i (H u)_i = 0, and neither does B
/// times such a field: the total momentum stays that of v* at any tolerance.
///
/// Norms are those of this inner product, the square root of twice a kinetic
/// energy: ‖r‖² = Σ m_i |r_i|². What counts in the end is the residual of the
/// equation itself, evaluated anew; if the recurrence of MINRES was too
/// optimistic about it, it starts again from there.
IntegrationReport solve(const Scene& scene, const ImplicitSystem& system, Grid& grid) {
  const auto B = [&](const NodeField& u) { return system.free_part(system.apply(u)); };
  const auto norm = [&](const NodeField& u) { return std::sqrt(inner_product(grid.m, u, u)); };
  const auto fail = [](const std::string& what) {
    throw SimulationError(Stage::integration, SimulationError::Subject::solver, -1, what);
  };

  const NodeField& v_star = grid.v_star;
  NodeField& v = grid.v_new;
  const double target = scene.integrator.tolerance * norm(v_star);
  double last_size = std::numeric_limits<double>::infinity();
  IntegrationReport report;
  while (true) {
    NodeField r = v_star;
    add_scaled(-1, system.apply(v), r);
    r = system.free_part(r);
    const double size = norm(r);
    if (!finite(size)) fail("residual is not finite");
    report.residual = size > 0 ? size / norm(v_star) : 0;
    if (size <= target) return report;
    if (!(size < last_size)) fail("residual stagnates at " + to_text(report.residual));
    last_size = size;

    const std::int64_t left = scene.integrator.max_iterations - report.iterations;
    if (left <= 0)
      fail("not converged after " + std::to_string(report.iterations) +
           " iterations: relative residual " + to_text(report.residual) + ", asked for " +
           to_text(scene.integrator.tolerance));
    const MinresResult done = minres(B, grid.m, r, target, left, v);
    report.iterations += done.iterations;
    report.indefinite |= done.indefinite;
  }
}

}  // namespace

/// Step 6. Integration (Stomakhin et al. 2013, §4.1 step 6):
///
///     explicit:        v_i^{n+1} = v_i*                              [m/s]
///     semi-implicit:   Σ_j (I δ_ij + βΔt² m_i⁻¹ ∂²Φ/∂x_i∂x_j) v_j^{n+1} = v_i*
///
/// The solve starts from v*; with β = 0 that is the solution.
IntegrationReport integration(const Scene& scene, const Particles& particles,
                              const Stencils& stencils, double dt, Grid& grid) {
  grid.v_new = grid.v_star;
  IntegrationReport report;
  if (scene.semi_implicit() && scene.integrator.implicitness > 0)
    report = solve(scene, ImplicitSystem(scene, particles, stencils, grid, dt), grid);
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (!finite(grid.v_new[i])) fail_at_node(Stage::integration, grid, i, "velocity is not finite");
  return report;
}

}  // namespace firn::reference
