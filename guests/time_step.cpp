#include "guests/time_step.hpp"

#include <Eigen/LU>
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

TimeStep time_step_by_rule(const Scene& scene, const Particles& particles) {
  const TimeSettings& time = scene.time;
  if (!time.adaptive) return {time.step, TimeStepBound::fixed};
  TimeStep chosen{time.max_step, TimeStepBound::max_step};
  // A NaN passes no comparison: it is for whoever judges the state to find.
  const auto limit = [&](double dt, TimeStepBound bound) {
    if (dt < chosen.dt) chosen = {dt, bound};
  };
  for (std::size_t p = 0; p < particles.size(); ++p) {
    limit(time.cfl * scene.grid.spacing / particles.v[p].norm(), TimeStepBound::cfl);
    if (!scene.semi_implicit())
      limit(time.elastic_cfl * scene.grid.spacing / sound_speed(scene, particles, p),
            TimeStepBound::elastic_cfl);
  }
  return chosen;
}

}  // namespace firn::guest
