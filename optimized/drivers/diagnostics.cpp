/// Sums over all particles, block by block on any thread, the blocks' sums added in
/// the order of the blocks: the same bits at any number of threads.

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "optimized/drivers/solver.hpp"

namespace firn::optimized {

namespace {

/// What one block contributes.
struct Sums {
  double mass = 0, kinetic = 0, elastic = 0, max_speed2 = 0;
  double min_J = std::numeric_limits<double>::infinity(), max_J = -min_J;
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero(), first_moment = Vec3::Zero();
};

}  // namespace

template <class T>
Diagnostics OptimizedSolver<T>::diagnostics(const Scene& scene) const {
  // The stress of a state that was only just loaded is not known yet.
  if (stress_stale_) return Solver::diagnostics(scene);
  const std::vector<int>& active = particles_.active();
  std::vector<Sums> sums(active.size());
  const int n = static_cast<int>(active.size());
#pragma omp parallel num_threads(threads_)
  {
    AlignedArray<T> numbers;
#pragma omp for schedule(dynamic, 4)
    for (int a = 0; a < n; ++a) {
      const Block<T>& block = particles_.block(active[static_cast<std::size_t>(a)]);
      const std::size_t room =
          static_cast<std::size_t>(block.count / page_particles + 1) * page_particles;
      numbers.require(2 * room);
      T* const energy = numbers.data();
      T* const J = energy + room;
      kernels_.measure(particles_.view(block), constants_, energy, J);
      Sums& s = sums[static_cast<std::size_t>(a)];
      for (int i = 0; i < block.count; ++i) {
        const auto m = static_cast<double>(particles_.value(block, i, slot_m));
        const Vec3 v(static_cast<double>(particles_.value(block, i, slot_v)),
                     static_cast<double>(particles_.value(block, i, slot_v + 1)),
                     static_cast<double>(particles_.value(block, i, slot_v + 2)));
        const Vec3 x = particles_.position(block, i);
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
    }
  }
  Sums all;
  for (const Sums& s : sums) {
    all.mass += s.mass, all.kinetic += s.kinetic, all.elastic += s.elastic;
    all.momentum += s.momentum, all.angular += s.angular, all.first_moment += s.first_moment;
    all.max_speed2 = std::max(all.max_speed2, s.max_speed2);
    all.min_J = std::min(all.min_J, s.min_J), all.max_J = std::max(all.max_J, s.max_J);
  }
  Diagnostics d;
  d.time = time_;
  d.mass = all.mass;
  d.momentum = all.momentum;
  d.angular_momentum = all.angular;
  d.kinetic_energy = all.kinetic;
  d.elastic_energy = all.elastic;
  d.gravitational_energy = -scene.gravity.dot(all.first_moment);
  if (all.mass > 0) d.center_of_mass = all.first_moment / all.mass;
  d.max_speed = std::sqrt(all.max_speed2);
  if (n > 0) d.min_J_E = 1 + all.min_J, d.max_J_E = 1 + all.max_J;
  return d;
}

template Diagnostics OptimizedSolver<float>::diagnostics(const Scene&) const;
template Diagnostics OptimizedSolver<double>::diagnostics(const Scene&) const;

}  // namespace firn::optimized
