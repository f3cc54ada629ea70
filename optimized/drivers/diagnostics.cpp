// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/drivers/diagnostics.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace firn::optimized {

namespace {

/// What some particles contribute.
struct Sums {
  double mass = 0, kinetic = 0, elastic = 0, max_speed2 = 0;
  double min_J = std::numeric_limits<double>::infinity(), max_J = -min_J;  ///< of J_E − 1
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero(), first_moment = Vec3::Zero();

  Sums& operator+=(const Sums& s) {
    mass += s.mass, kinetic += s.kinetic, elastic += s.elastic;
    momentum += s.momentum, angular += s.angular, first_moment += s.first_moment;
    max_speed2 = std::max(max_speed2, s.max_speed2);
    min_J = std::min(min_J, s.min_J), max_J = std::max(max_J, s.max_J);
    return *this;
  }
};

template <class T>
Sums sums_of(const Simulation<T>& sim, const Block<T>& block, AlignedArray<T>& numbers) {
  const std::size_t room = (block.count / page_particles + 1) * page_particles;
  numbers.require(2 * room);
  T* const energy = numbers.data();
  T* const J = energy + room;
  sim.kernels.measure(sim.particles.view(block), sim.constants, energy, J);
  Sums s;
  for (std::size_t i = 0; i < block.count; ++i) {
    const auto m = static_cast<double>(sim.particles.value(block, i, slot_m));
    const Vec3 v = sim.particles.vector(block, i, slot_v);
    const Vec3 x = sim.particles.position(block, i);
    s.mass += m;
    s.momentum += m * v;
    s.angular += m * x.cross(v);
    s.first_moment += m * x;
    s.kinetic += 0.5 * m * v.squaredNorm();
    s.elastic += static_cast<double>(energy[i]);
    s.max_speed2 = std::max(s.max_speed2, v.squaredNorm());
    s.min_J = std::min(s.min_J, static_cast<double>(J[i]));
    s.max_J = std::max(s.max_J, static_cast<double>(J[i]));
  }
  return s;
}

template <class T>
Sums sums_of_all(const Simulation<T>& sim) {
  const std::size_t n = sim.particles.active().size();
  std::vector<Sums> sums(n);
#pragma omp parallel num_threads(sim.threads)
  {
    AlignedArray<T> numbers;
#pragma omp for schedule(dynamic, 4)
    for (std::size_t a = 0; a < n; ++a)
      sums[a] = sums_of(sim, sim.particles.active_block(a), numbers);
  }
  Sums all;
  for (const Sums& s : sums) all += s;
  return all;
}

}  // namespace

template <class T>
Diagnostics diagnostics_of(const Simulation<T>& sim) {
  const Sums all = sums_of_all(sim);
  Diagnostics d;
  d.time = sim.time;
  d.mass = all.mass;
  d.momentum = all.momentum;
  d.angular_momentum = all.angular;
  d.kinetic_energy = all.kinetic;
  d.elastic_energy = all.elastic;
  d.gravitational_energy = -sim.scene->gravity.dot(all.first_moment);
  if (all.mass > 0) d.center_of_mass = all.first_moment / all.mass;
  d.max_speed = std::sqrt(all.max_speed2);
  if (sim.particles.size() > 0) d.min_J_E = 1 + all.min_J, d.max_J_E = 1 + all.max_J;
  return d;
}

template Diagnostics diagnostics_of(const Simulation<float>&);
template Diagnostics diagnostics_of(const Simulation<double>&);

}  // namespace firn::optimized
