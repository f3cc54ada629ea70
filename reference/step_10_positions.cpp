// SPDX-License-Identifier: BSD-3-Clause
#include "reference/failure.hpp"
#include "reference/steps.hpp"

namespace firn::reference {

/// Step 10. Positions (Stomakhin et al. 2013, §4.1 step 10):
///
///     x_p = x_p + Δt v_p                    [m]
///
/// with the velocity after step 9, wrapped along periodic axes.
void positions(const Scene& scene, double dt, Particles& particles) {
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Vec3 x_p = scene.wrap(particles.x[p] + dt * particles.v[p]);
    if (!inside_domain(scene.grid, x_p)) fail_at_particle(Stage::positions, p, outside_domain(x_p));
    particles.x[p] = x_p;
  }
}

}  // namespace firn::reference
