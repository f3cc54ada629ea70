// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Loops over blocks on all threads. Which thread takes which block has no influence on any bit.

#include "optimized/drivers/simulation.hpp"

namespace firn::optimized {

template <class T>
ThreadMemory<T>& memory_of_this_thread(Simulation<T>& sim) {
  return sim.memory[this_thread()];
}

/// f(a, memory of the thread) for every active block, a = 0 … n−1. Neighbours go to one thread.
template <class T, class F>
void for_each_active_block(Simulation<T>& sim, const F& f) {
  const std::size_t n = sim.particles.active().size();
#pragma omp parallel for num_threads(sim.threads) schedule(dynamic, blocks_per_turn(n, sim.threads))
  for (std::size_t a = 0; a < n; ++a) f(a, memory_of_this_thread(sim));
}

/// f(n, memory of the thread) for every node block.
template <class T, class F>
void for_each_node_block(Simulation<T>& sim, const F& f) {
  const std::size_t blocks = sim.nodes.size();
#pragma omp parallel for num_threads(sim.threads)
  for (std::size_t n = 0; n < blocks; ++n) f(n, memory_of_this_thread(sim));
}

}  // namespace firn::optimized
