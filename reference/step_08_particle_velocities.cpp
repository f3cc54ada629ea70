// SPDX-License-Identifier: BSD-3-Clause
#include "reference/failure.hpp"
#include "reference/steps.hpp"
#include "reference/transfer.hpp"

namespace firn::reference {

/// Step 8. Particle velocities (Stomakhin et al. 2013, §4.1 step 8):
///
///     v_PIC  = Σ_i v_i^{n+1} w_ip
///     v_FLIP = v_p + Σ_i (v_i^{n+1} − v_i^n) w_ip
///     v_p    = (1 − α) v_PIC + α v_FLIP     [m/s]
///
/// v_i^n is the velocity of step 1; the weights are those of time n.
void particle_velocities(const Scene& scene, const Stencils& stencils, const Grid& grid,
                         Particles& particles) {
  for (std::size_t p = 0; p < particles.size(); ++p) {
    gather_velocity(scene, grid, p, stencils, particles);
    if (!finite(particles.v[p]))
      fail_at_particle(Stage::particle_velocities, p, "velocity is not finite");
  }
}

}  // namespace firn::reference
