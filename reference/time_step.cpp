// SPDX-License-Identifier: BSD-3-Clause
#include "reference/time_step.hpp"

#include <algorithm>

#include "reference/constitutive.hpp"
#include "reference/failure.hpp"

namespace firn::reference {

namespace {

double fastest_particle(const Particles& particles) {
  double fastest = 0;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const double speed = particles.v[p].norm();
    if (!finite(speed)) fail_at_particle(Stage::rasterize, p, "velocity is not finite");
    fastest = std::max(fastest, speed);
  }
  return fastest;
}

double fastest_sound(const Scene& scene, const Particles& particles) {
  double fastest = 0;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Material& material = scene.materials[static_cast<std::size_t>(particles.material[p])];
    const double V_p0 = particles.V_0[p];
    const double rho_p = V_p0 > 0 ? particles.m[p] / V_p0 : material.density;
    const double c_p = sound_speed(material, particles.F_P[p], rho_p);
    if (!finite(c_p)) fail_at_particle(Stage::grid_forces, p, "sound speed is not finite");
    fastest = std::max(fastest, c_p);
  }
  return fastest;
}

}  // namespace

TimeStep choose_time_step(const Scene& scene, const Particles& particles) {
  if (!scene.time.adaptive) return time_step_by_rule(scene, 0, 0);
  const double sound = scene.semi_implicit() ? 0 : fastest_sound(scene, particles);
  return time_step_by_rule(scene, fastest_particle(particles), sound);
}

}  // namespace firn::reference
