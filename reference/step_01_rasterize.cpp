// SPDX-License-Identifier: BSD-3-Clause
#include "reference/failure.hpp"
#include "reference/steps.hpp"
#include "reference/transfer.hpp"

namespace firn::reference {

/// Step 1. Rasterize particle data to the grid (Stomakhin et al. 2013, §4.1 step 1):
///
///     m_i = Σ_p m_p w_ip                    [kg]
///     v_i = (Σ_p v_p m_p w_ip) / m_i        [m/s]
///
/// The division makes Σ_i m_i v_i = Σ_p m_p v_p: momentum is conserved. However
/// light a node is, it takes part; a threshold on m_i would lose exactly the
/// momentum it cuts off. v_i is kept to the end of the step: step 8 needs it.
void rasterize(const Particles& particles, const Stencils& stencils, Grid& grid) {
  grid.m.assign(grid.size(), 0.0);
  grid.v.assign(grid.size(), Vec3::Zero());
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const double m_p = particles.m[p];
    if (!(m_p > 0 && finite(m_p)))
      fail_at_particle(Stage::rasterize, p, "mass is " + to_text(m_p) + ", allowed: > 0");
    if (!finite(particles.v[p])) fail_at_particle(Stage::rasterize, p, "velocity is not finite");
    scatter_mass_and_momentum(particles, p, stencils, grid.m, grid.v);
  }
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.m[i] == 0) continue;
    grid.v[i] /= grid.m[i];  // was the momentum so far
    if (!finite(grid.m[i]) || !finite(grid.v[i]))
      fail_at_node(Stage::rasterize, grid, i, "mass or velocity is not finite");
  }
}

}  // namespace firn::reference
