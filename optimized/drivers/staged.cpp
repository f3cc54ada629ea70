// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/drivers/staged.hpp"

#include <algorithm>

#include "firn/error.hpp"
#include "optimized/drivers/collisions.hpp"
#include "optimized/drivers/finite.hpp"
#include "optimized/drivers/integration.hpp"
#include "optimized/drivers/nodes.hpp"
#include "optimized/drivers/particles.hpp"
#include "optimized/drivers/step.hpp"
#include "optimized/drivers/volumes.hpp"

namespace firn::optimized {

namespace {

template <class T>
void rasterize(Simulation<T>& sim) {
  sim.solved = {};
  refresh_stress(sim);
  scatter_all(sim);
  for_each_node_block(sim, [&](std::size_t n, ThreadMemory<T>& memory) {
    sum_tiles(sim, n, memory, sim.nodes.fields(n));
    sim.kernels.node_velocities(sim.nodes.fields(n));
  });
  require_finite_particles(sim, Stage::rasterize, slot_v, 3, "velocity is not finite");
  require_finite_particles(sim, Stage::rasterize, slot_m, 1, "mass is not finite");
  require_finite_nodes(sim, Stage::rasterize, &NodeFields<T>::v);
}

template <class T>
void grid_forces(Simulation<T>& sim) {
  refresh_stress(sim);
  require_finite_particles(sim, Stage::grid_forces, slot_stiffness, 1,
                           "hardening exp(xi (1 - J_P)) is not finite");
  require_finite_particles(sim, Stage::grid_forces, slot_tau, 6, "stress is not finite");
  // Stage 1 fills the tiles, with the stress as it is then.
  if (sim.entered != Stage::rasterize || sim.volumes == Volumes::estimated) scatter_all(sim);
  for_each_node_block(sim, [&](std::size_t n, ThreadMemory<T>& memory) {
    NodeFields<T>& node = *memory.node.data();
    sum_tiles(sim, n, memory, node);
    sim.kernels.node_forces(sim.constants, node);
    std::copy_n(&node.f[0][0], 3 * nodes_per_block, &sim.nodes.fields(n).f[0][0]);
  });
  require_finite_nodes(sim, Stage::grid_forces, &NodeFields<T>::f);
}

template <class T>
void grid_velocities(Simulation<T>& sim) {
  for_each_node_block(sim, [&](std::size_t n, ThreadMemory<T>&) {
    sim.kernels.node_velocities_star(sim.constants, sim.nodes.fields(n));
  });
  require_finite_nodes(sim, Stage::grid_velocities, &NodeFields<T>::v_star);
}

template <class T>
void grid_collisions(Simulation<T>& sim) {
  if (sim.semi_implicit()) sim.implicit.release(sim.nodes.size());
  for_each_node_block(sim, [&](std::size_t n, ThreadMemory<T>& memory) {
    collide_nodes(sim, n, memory.colliders, sim.nodes.fields(n));
  });
  require_finite_nodes(sim, Stage::grid_collisions, &NodeFields<T>::v_star);
}

/// What stages 7 and 8 gather, from the fields that are kept.
template <class T>
void pack_fields(Simulation<T>& sim) {
  pack_all(sim, [&](std::size_t n) -> const NodeMotion<T>& { return sim.nodes.fields(n); });
  require_finite_nodes(sim, Stage::integration, &NodeFields<T>::v_star);
}

/// Step 6. Explicit: v^{n+1} = v*, which is there.
template <class T>
void integration(Simulation<T>& sim) {
  if (sim.semi_implicit()) solve_kept_fields(sim);
  pack_fields(sim);
}

template <class T>
void deformation(Simulation<T>& sim) {
  refresh_stress(sim);  // for the hardened stiffness of particles that were only just loaded
  if (sim.entered == Stage::deformation) pack_fields(sim);
  update_particles(sim, pass_deformation, false);
  sim.stress_stale = false;
}

template <class T>
void particle_velocities(Simulation<T>& sim) {
  if (sim.entered == Stage::particle_velocities) pack_fields(sim);
  update_particles(sim, pass_velocity, false);
}

template <class T>
void positions(Simulation<T>& sim) {
  update_particles(sim, pass_position, false);
  sim.particles.put_in(sim.threads);
}

template <class T>
std::int64_t grid_nodes(const NodeStore<T>& nodes) {
  std::int64_t count = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) count += count_nodes(nodes.fields(n));
  return count;
}

}  // namespace

template <class T>
void run_stage(Simulation<T>& sim, Stage stage) {
  switch (stage) {
    case Stage::rasterize: return rasterize(sim);
    case Stage::volumes: return estimate_volumes(sim);
    case Stage::grid_forces: return grid_forces(sim);
    case Stage::grid_velocities: return grid_velocities(sim);
    case Stage::grid_collisions: return grid_collisions(sim);
    case Stage::integration: return integration(sim);
    case Stage::deformation: return deformation(sim);
    case Stage::particle_velocities: return particle_velocities(sim);
    case Stage::particle_collisions: return update_particles(sim, 0, true);
    case Stage::positions: return positions(sim);
  }
}

template <class T>
StepReport run_stages(Simulation<T>& sim, Stage last, double dt) {
  begin_step(sim, dt);
  sim.nodes.follow(sim.particles, sim.kernels.shape, sim.skips.empty);
  sim.nodes.require_fields();
  try {
    for (Stage stage = sim.next;; stage = next(stage)) {
      run_stage(sim, stage);
      sim.next = next(stage);
      if (stage == last) break;
    }
  } catch (SimulationError& error) {
    // Up to the integration nothing but the estimated volumes has been written.
    error.state_intact =
        number(sim.next) <= number(Stage::integration) && sim.volumes != Volumes::estimated;
    sim.next = sim.entered = Stage::rasterize;
    sim.solved = {};
    throw;
  }
  const StepReport report = report_of(sim, grid_nodes(sim.nodes));
  if (last == Stage::positions) finish_step(sim);
  return report;
}

template void run_stage(Simulation<float>&, Stage);
template void run_stage(Simulation<double>&, Stage);
template StepReport run_stages(Simulation<float>&, Stage, double);
template StepReport run_stages(Simulation<double>&, Stage, double);

}  // namespace firn::optimized
