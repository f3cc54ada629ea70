// SPDX-License-Identifier: BSD-3-Clause
#include "reference/collision.hpp"
#include "reference/failure.hpp"
#include "reference/steps.hpp"

namespace firn::reference {

/// Step 9. Particle-based body collisions (Stomakhin et al. 2013, §4.1 step 9 and
/// section 8): as step 5, on v_p at x_p^n. The grid cannot resolve a contact to
/// less than a cell; this keeps the single particle from crossing it.
void particle_collisions(const Scene& scene, double t, Particles& particles) {
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Vec3& x_p = particles.x[p];
    for (const Collider& collider : scene.colliders)
      if (collider.phi(x_p, t) <= 0) collide(collider, collider.contact(x_p, t), particles.v[p]);
    if (!finite(particles.v[p]))
      fail_at_particle(Stage::particle_collisions, p, "velocity is not finite");
  }
}

}  // namespace firn::reference
