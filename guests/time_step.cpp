// SPDX-License-Identifier: BSD-3-Clause
#include "guests/time_step.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace firn::guest {

namespace {

double sound_speed(const Scene& scene, const Particles& particles, std::size_t p) {
  const Material& material = scene.materials[static_cast<std::size_t>(particles.material[p])];
  const double harder = std::exp(material.hardening * (1 - particles.F_P[p].determinant()));
  const double V_p0 = particles.V_0[p];
  const double rho_p = V_p0 > 0 ? particles.m[p] / V_p0 : material.density;
  return std::sqrt(harder * (material.lambda_0() + 2 * material.mu_0()) / rho_p);
}

}  // namespace

TimeStep choose_time_step(const Scene& scene, const Particles& particles) {
  // A NaN does not compare: whoever judges the state finds it.
  double fastest_particle = 0, fastest_sound = 0;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    fastest_particle = std::max(fastest_particle, particles.v[p].norm());
    fastest_sound = std::max(fastest_sound, sound_speed(scene, particles, p));
  }
  return time_step_by_rule(scene, fastest_particle, fastest_sound);
}

}  // namespace firn::guest
