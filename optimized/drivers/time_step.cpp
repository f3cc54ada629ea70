// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/drivers/time_step.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "firn/error.hpp"
#include "optimized/drivers/parallel.hpp"
#include "optimized/drivers/step.hpp"

namespace firn::optimized {

namespace {

/// c_p² = (λ + 2μ)/ρ with 2 μ V_p0 at hand; before volumes are known ρ = ρ_0.
template <class T>
double sound_speed_squared(const Simulation<T>& sim, const Block<T>& block, std::size_t i) {
  const ParticleStore<T>& particles = sim.particles;
  const auto k = static_cast<std::size_t>(particles.material(block, i));
  const Material& material = sim.scene->materials[k];
  const auto V_0 = static_cast<double>(particles.value(block, i, slot_V_0));
  const auto m = static_cast<double>(particles.value(block, i, slot_m));
  double two_mu = static_cast<double>(particles.value(block, i, slot_stiffness)) / V_0;
  double rho = m / V_0;
  if (V_0 == 0) {
    const Mat3 F_P = particles.identity_plus(block, i, slot_E_P);
    const double J_P = F_P.row(0).dot(F_P.row(1).cross(F_P.row(2)));
    two_mu = 2 * material.mu_0() * std::exp(material.hardening * (1 - J_P));
    rho = material.density;
  }
  return two_mu * (1 + material.lambda_0() / (2 * material.mu_0())) / rho;
}

struct Speeds {
  double particle_squared = 0, sound_squared = 0;  ///< the largest; infinity for NaN
};

template <class T>
Speeds largest_speeds(Simulation<T>& sim) {
  const ParticleStore<T>& particles = sim.particles;
  const std::size_t n = particles.active().size();
  double speed2 = 0, sound2 = 0;
#pragma omp parallel for num_threads(sim.threads)                    \
    schedule(dynamic, blocks_per_turn(n, sim.threads)) reduction(max \
                                                                 : speed2, sound2)
  for (std::size_t a = 0; a < n; ++a) {
    const Block<T>& block = particles.active_block(a);
    for (std::size_t i = 0; i < block.count; ++i) {
      double v2 = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const auto v = static_cast<double>(particles.value(block, i, slot_v + axis));
        v2 += v * v;
      }
      const double c2 = sound_speed_squared(sim, block, i);
      // Infinity instead of NaN: max would lose it.
      speed2 = std::max(speed2, std::isnan(v2) ? INFINITY : v2);
      sound2 = std::max(sound2, std::isnan(c2) ? INFINITY : c2);
    }
  }
  return {speed2, sound2};
}

}  // namespace

template <class T>
TimeStep choose_time_step(Simulation<T>& sim) {
  const Scene& scene = *sim.scene;
  if (!scene.time.adaptive) return time_step_by_rule(scene, 0, 0);
  begin_step(sim, scene.time.max_step);
  refresh_stress(sim);
  const auto [speed2, sound2] = largest_speeds(sim);
  if (!std::isfinite(speed2) || !std::isfinite(sound2)) {
    SimulationError error(std::isfinite(speed2) ? Stage::grid_forces : Stage::rasterize,
                          SimulationError::Subject::solver, -1,
                          "particle or sound speed is not finite");
    error.state_intact = true;
    throw error;
  }
  return time_step_by_rule(scene, std::sqrt(speed2), std::sqrt(sound2));
}

template TimeStep choose_time_step(Simulation<float>&);
template TimeStep choose_time_step(Simulation<double>&);

}  // namespace firn::optimized
