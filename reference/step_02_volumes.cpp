// SPDX-License-Identifier: BSD-3-Clause
#include "reference/failure.hpp"
#include "reference/steps.hpp"

namespace firn::reference {

/// Step 2. Particle volumes and densities (Stomakhin et al. 2013, §4.1 step 2),
/// in the first step only:
///
///     ρ_p0 = Σ_i m_i w_ip / h³              [kg/m³]
///     V_p0 = m_p / ρ_p0                     [m³]
///
/// A volume which the scene states, or which an earlier step found, stays.
void volumes(const Scene& scene, const Stencils& stencils, const Grid& grid, Particles& particles) {
  const double h = scene.grid.spacing;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    double& V_p0 = particles.V_0[p];
    if (V_p0 == 0) {
      double rho_p0 = 0;
      stencils.for_each_node(
          p, [&](std::size_t i, double w_ip) { rho_p0 += grid.m[i] * w_ip / (h * h * h); });
      V_p0 = particles.m[p] / rho_p0;
    }
    if (!(V_p0 > 0 && finite(V_p0)))
      fail_at_particle(Stage::volumes, p, "volume is " + to_text(V_p0) + ", allowed: > 0");
  }
}

}  // namespace firn::reference
