// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/drivers/particles.hpp"

#include <span>
#include <utility>

#include "firn/error.hpp"
#include "optimized/drivers/collisions.hpp"
#include "optimized/drivers/parallel.hpp"

namespace firn::optimized {

namespace {

constexpr int gathering = pass_deformation | pass_velocity;

/// A fault in a kernel, and the place of its block among the active ones.
struct Found {
  std::size_t block = 0;
  FaultReport report;
};

/// What stages 7 and 8 gather from, in the thread's workspace.
template <class T>
void load_surroundings(const Simulation<T>& sim, std::size_t a, const Workspace<T>& work) {
  sim.nodes.load_surroundings(
      a, sim.kernels, [&](std::size_t n) { return sim.nodes.gathered(n); }, work.local);
  sim.kernels.difference(work);
}

/// Some of stages 7 to 10 for one block; returns the number of leavers.
template <class T>
int update_block(Simulation<T>& sim, std::size_t a, int passes, bool collide,
                 ThreadMemory<T>& memory, FaultReport& report) {
  const Block<T>& block = sim.particles.active_block(a);
  const BlockView<T> view = sim.particles.view(block);
  const auto update = [&](int some) {
    return sim.kernels.update(view, sim.constants, memory.work, some, report);
  };
  if (passes & gathering) load_surroundings(sim, a, memory.work);
  memory.colliders.clear();
  if (collide && !sim.scene->colliders.empty()) find_colliders(sim, block, memory.colliders);
  if (memory.colliders.empty()) return update(passes);
  // Particles collide between stages 8 and 10.
  if (passes & gathering) update(passes & gathering);
  collide_particles(sim, block, memory.colliders);
  return passes & pass_position ? update(pass_position) : 0;
}

/// Names the particle. Its block has not given any away.
template <class T>
[[noreturn]] void fail(const Simulation<T>& sim, const Found& found) {
  const auto [stage, what] = [&]() -> std::pair<Stage, const char*> {
    switch (found.report.fault) {
      case Fault::deformation: return {Stage::deformation, "deformation gradient is not finite"};
      case Fault::velocity: return {Stage::particle_velocities, "velocity is not finite"};
      default:
        return {Stage::positions,
                "particle moves more than 4 cells in a step or leaves the domain"};
    }
  }();
  const std::size_t p =
      sim.particles.index(sim.particles.active_block(found.block), found.report.place);
  throw SimulationError(stage, SimulationError::Subject::particle, static_cast<std::int64_t>(p),
                        what);
}

}  // namespace

template <class T>
void update_particles(Simulation<T>& sim, int passes, bool collide) {
  Found found;
  for_each_active_block(sim, [&](std::size_t a, ThreadMemory<T>& memory) {
    FaultReport report;
    const int leavers = update_block(sim, a, passes, collide, memory, report);
    if ((passes & pass_position) && report.fault == Fault::none) {
      const std::span<const std::int32_t> places(memory.work.leavers, leavers);
      const int lost = sim.particles.take_out(sim.particles.active_block(a), places);
      if (lost != sim.particles.nobody) report = {Fault::position, lost};
    }
    if (report.fault == Fault::none) return;
#pragma omp critical(firn_fault)
    if (found.report.fault == Fault::none || a < found.block) found = {a, report};
  });
  if (found.report.fault != Fault::none) fail(sim, found);
}

template void update_particles(Simulation<float>&, int, bool);
template void update_particles(Simulation<double>&, int, bool);

}  // namespace firn::optimized
