// SPDX-License-Identifier: BSD-3-Clause
#include "reference/constitutive.hpp"
#include "reference/failure.hpp"
#include "reference/steps.hpp"
#include "reference/transfer.hpp"

namespace firn::reference {

/// Step 7. Deformation gradient (Stomakhin et al. 2013, §4.1 step 7):
///
///     ∇v_p = Σ_i v_i^{n+1} (∇w_ip)ᵀ         [1/s]
///     F̂_E = (I + Δt ∇v_p) F_E,   F^{n+1} = F̂_E F_P
///
/// First all the change is taken to be elastic; then the return map of the
/// material makes the part of F̂_E beyond the elastic limits plastic.
void deformation(const Scene& scene, const Stencils& stencils, const Grid& grid, double dt,
                 Particles& particles) {
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Mat3 grad_v_p = gather_gradient(grid.v_new, p, stencils);
    const Mat3 F_E_hat = (Mat3::Identity() + dt * grad_v_p) * particles.F_E[p];
    const Material& material = scene.materials[static_cast<std::size_t>(particles.material[p])];
    return_map(material, F_E_hat, particles.F_E[p], particles.F_P[p]);
    if (!finite(particles.F_E[p]) || !finite(particles.F_P[p]))
      fail_at_particle(Stage::deformation, p, "deformation gradient is not finite");
  }
}

}  // namespace firn::reference
