// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/drivers/nodes.hpp"

#include <algorithm>

namespace firn::optimized {

namespace {

/// Every block is sorted again each 16th step; which one when depends on where it
/// lies, so that no step sorts all of them.
constexpr std::int64_t sort_interval = 16;

bool sort_is_due(const NodeIndex& b, std::int64_t step) {
  return (step + b.i + 3 * b.j + 5 * b.k) % sort_interval == 0;
}

}  // namespace

template <class T>
void scatter_all(Simulation<T>& sim) {
  ParticleStore<T>& particles = sim.particles;
  const std::size_t n = particles.active().size();
  for_each_active_block(sim, [&](std::size_t a, ThreadMemory<T>& memory) {
    Block<T>& block = particles.active_block(a);
    if (sort_is_due(block.b, sim.step)) particles.sort(block, memory.sorting);
    // Most often this thread's next block; its particles are asked for in advance.
    BlockView<T> next{};
    if (a + 1 < n) next = particles.view(particles.active_block(a + 1));
    sim.kernels.scatter(particles.view(block), a + 1 < n ? &next : nullptr, sim.constants,
                        memory.work, sim.nodes.tile(a));
  });
}

template <class T>
void sum_tiles(const Simulation<T>& sim, std::size_t n, ThreadMemory<T>& memory,
               NodeFields<T>& node) {
  for (const Share& share : sim.nodes.shares(n))
    sim.kernels.add_tile(sim.nodes.tile(share.tile_number), share.region, memory.sums.data());
  sim.kernels.planar(memory.sums.data(), node);
}

template <class T>
std::int64_t count_nodes(const NodeFields<T>& node) {
  return std::count_if(node.m, node.m + nodes_per_block, [](T m) { return m > 0; });
}

template void scatter_all(Simulation<float>&);
template void scatter_all(Simulation<double>&);
template void sum_tiles(const Simulation<float>&, std::size_t, ThreadMemory<float>&,
                        NodeFields<float>&);
template void sum_tiles(const Simulation<double>&, std::size_t, ThreadMemory<double>&,
                        NodeFields<double>&);
template std::int64_t count_nodes(const NodeFields<float>&);
template std::int64_t count_nodes(const NodeFields<double>&);

}  // namespace firn::optimized
