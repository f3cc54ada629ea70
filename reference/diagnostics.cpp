// SPDX-License-Identifier: BSD-3-Clause
#include "reference/diagnostics.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

#include "reference/constitutive.hpp"

namespace firn::reference {

Diagnostics measure(const Scene& scene, const State& state) {
  const Particles& particles = state.particles;
  Diagnostics d;
  d.time = state.time;
  Vec3 first_moment = Vec3::Zero();
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Vec3 &x_p = particles.x[p], &v_p = particles.v[p];
    const double m_p = particles.m[p];
    d.mass += m_p;
    d.momentum += m_p * v_p;
    d.angular_momentum += m_p * x_p.cross(v_p);
    d.kinetic_energy += 0.5 * m_p * v_p.squaredNorm();
    first_moment += m_p * x_p;
    d.max_speed = std::max(d.max_speed, v_p.norm());

    const Material& material = scene.materials[static_cast<std::size_t>(particles.material[p])];
    const Mat3& F_E = particles.F_E[p];
    const double J_E = F_E.determinant();
    d.elastic_energy += particles.V_0[p] * energy_density(material, F_E, particles.F_P[p]);
    d.min_J_E = p == 0 ? J_E : std::min(d.min_J_E, J_E);
    d.max_J_E = p == 0 ? J_E : std::max(d.max_J_E, J_E);
  }
  d.gravitational_energy = -scene.gravity.dot(first_moment);
  if (d.mass > 0) d.center_of_mass = first_moment / d.mass;
  return d;
}

}  // namespace firn::reference
