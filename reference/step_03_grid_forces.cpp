// SPDX-License-Identifier: BSD-3-Clause
#include "reference/constitutive.hpp"
#include "reference/failure.hpp"
#include "reference/steps.hpp"
#include "reference/transfer.hpp"

namespace firn::reference {

/// Step 3. Grid forces (Stomakhin et al. 2013, §4.1 step 3 and eq. 6):
///
///     f_i = − Σ_p V_p σ_p ∇w_ip = − Σ_p V_p0 P_p F_Eᵀ ∇w_ip      [N]
///     P_p F_Eᵀ = 2μ(F_E − R_E) F_Eᵀ + λ(J_E − 1) J_E I
///
/// V_p = J_p V_p0 and σ_p = P_p F_Eᵀ / J_p: the J_p cancel.
void grid_forces(const Scene& scene, const Particles& particles, const Stencils& stencils,
                 Grid& grid) {
  grid.f.assign(grid.size(), Vec3::Zero());
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Material& material = scene.materials[static_cast<std::size_t>(particles.material[p])];
    const Mat3& F_P = particles.F_P[p];
    const Mat3 V_tau = particles.V_0[p] * kirchhoff_stress(material, particles.F_E[p], F_P);
    if (!finite(V_tau)) fail_at_particle(Stage::grid_forces, p, why_not_finite(material, F_P));
    scatter_divergence(-V_tau, p, stencils, grid.f);
  }
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (!finite(grid.f[i])) fail_at_node(Stage::grid_forces, grid, i, "force is not finite");
}

}  // namespace firn::reference
