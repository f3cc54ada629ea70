// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/drivers/fused.hpp"

#include "firn/error.hpp"
#include "optimized/drivers/collisions.hpp"
#include "optimized/drivers/integration.hpp"
#include "optimized/drivers/nodes.hpp"
#include "optimized/drivers/particles.hpp"
#include "optimized/drivers/staged.hpp"
#include "optimized/drivers/step.hpp"
#include "optimized/drivers/volumes.hpp"

namespace firn::optimized {

namespace {

struct NodePass {
  std::int64_t nodes = 0;  ///< of positive mass
  bool finite = true;      ///< v* is
};

/// Stages 1 and 3 to 5 on every node block, and what stages 7 and 8 gather if there is no solve.
template <class T>
NodePass nodes_pass(Simulation<T>& sim, bool keep_fields) {
  const KernelTable<T>& kernels = sim.kernels;
  const std::size_t blocks = sim.nodes.size();
  const std::size_t turn = blocks_per_turn(blocks, sim.threads);
  std::int64_t count = 0;
  bool finite = true;
#pragma omp parallel for num_threads(sim.threads) schedule(dynamic, turn) \
    reduction(+ : count) reduction(&& : finite)
  for (std::size_t n = 0; n < blocks; ++n) {
    ThreadMemory<T>& memory = memory_of_this_thread(sim);
    NodeFields<T>& node = keep_fields ? sim.nodes.fields(n) : *memory.node.data();
    sum_tiles(sim, n, memory, node);
    kernels.node_velocities(node);
    kernels.node_forces(sim.constants, node);
    kernels.node_velocities_star(sim.constants, node);
    collide_nodes(sim, n, memory.colliders, node);
    finite = kernels.pack_gathered(sim.constants, node, sim.nodes.gathered(n)) && finite;
    if (sim.semi_implicit()) sim.implicit.motion[n] = node;
    count += count_nodes(node);
  }
  return {count, finite};
}

/// Stage 6; whether v_i^{n+1} is finite.
template <class T>
bool solve_and_pack(Simulation<T>& sim) {
  solve_implicit(sim);
  return pack_all(sim,
                  [&](std::size_t n) -> const NodeMotion<T>& { return sim.implicit.motion[n]; });
}

}  // namespace

template <class T>
StepReport fused_step(Simulation<T>& sim, double dt) {
  begin_step(sim, dt);
  sim.nodes.follow(sim.particles, sim.kernels.shape, sim.skips.empty);
  refresh_stress(sim);
  scatter_all(sim);

  const bool keep_fields = !sim.skips.fields || !sim.skips.volumes;
  if (keep_fields) sim.nodes.require_fields();
  if (sim.semi_implicit()) sim.implicit.release(sim.nodes.size());
  auto [nodes, finite] = nodes_pass(sim, keep_fields);
  if (finite && sim.semi_implicit()) finite = solve_and_pack(sim);
  // No particle has changed yet: the staged driver finds out what went wrong and where.
  if (!finite) {
    run_stages(sim, Stage::integration, dt);
    throw SimulationError(Stage::integration, SimulationError::Subject::solver, -1,
                          "velocity is not finite");
  }
  if (!sim.skips.volumes) estimate_volumes(sim);

  update_particles(sim, pass_deformation | pass_velocity | pass_position, true);
  sim.particles.put_in(sim.threads);
  const StepReport report = report_of(sim, nodes);
  finish_step(sim);
  return report;
}

template StepReport fused_step(Simulation<float>&, double);
template StepReport fused_step(Simulation<double>&, double);

}  // namespace firn::optimized
