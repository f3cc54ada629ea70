// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/drivers/step.hpp"

#include "optimized/drivers/parallel.hpp"

namespace firn::optimized {

template <class T>
void begin_step(Simulation<T>& sim, double dt) {
  const Scene& scene = *sim.scene;
  sim.dt = dt;
  StepConstants<T>& c = sim.constants;
  c.materials = sim.materials.data();
  c.material_count = static_cast<int>(sim.materials.size());
  c.slots = static_cast<int>(sim.particles.slots());
  c.dt = static_cast<T>(dt);
  c.dt_over_h = static_cast<T>(dt / scene.grid.spacing);
  c.minus_inv_h = static_cast<T>(-1 / scene.grid.spacing);
  for (int a = 0; a < 3; ++a) c.gravity_dt[a] = static_cast<T>(dt * scene.gravity[a]);
  c.flip = static_cast<T>(scene.flip);
  c.skip = sim.skips.kernels;
  sim.contacts = Contacts(scene, sim.time, sim.skips.friction);
  for (ThreadMemory<T>& m : sim.memory) m.require(sim.particles.largest_block(), sim.kernels.shape);
}

template <class T>
void refresh_stress(Simulation<T>& sim) {
  if (!sim.stress_stale) return;
  for_each_active_block(sim, [&](std::size_t a, ThreadMemory<T>&) {
    sim.kernels.stress(sim.particles.view(sim.particles.active_block(a)), sim.constants);
  });
  sim.stress_stale = false;
}

template <class T>
StepReport report_of(const Simulation<T>& sim, std::int64_t grid_nodes) {
  StepReport report;
  report.dt = sim.dt;
  report.grid_nodes = grid_nodes;
  report.solver_iterations = sim.solved.iterations;
  report.solver_residual = sim.solved.residual;
  report.solver_indefinite = sim.solved.indefinite;
  return report;
}

template <class T>
void finish_step(Simulation<T>& sim) {
  sim.time += sim.dt;
  sim.step += 1;
  sim.dt = 0;
  sim.next = sim.entered = Stage::rasterize;
  if (sim.volumes == Volumes::estimated) sim.volumes = Volumes::known;
  sim.solved = {};
}

template void begin_step(Simulation<float>&, double);
template void begin_step(Simulation<double>&, double);
template void refresh_stress(Simulation<float>&);
template void refresh_stress(Simulation<double>&);
template StepReport report_of(const Simulation<float>&, std::int64_t);
template StepReport report_of(const Simulation<double>&, std::int64_t);
template void finish_step(Simulation<float>&);
template void finish_step(Simulation<double>&);

}  // namespace firn::optimized
