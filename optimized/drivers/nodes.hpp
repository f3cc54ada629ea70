// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// From particles to node blocks and back: stages 1 and 3, and what stages 7 and 8 gather.

#include "optimized/drivers/parallel.hpp"

namespace firn::optimized {

/// Stages 1 and 3: every block's particles onto its tile. Sorts the blocks whose turn it is.
template <class T>
void scatter_all(Simulation<T>& sim);

/// Momentum, mass and Σ A ∂w of node block n from the tiles that meet it, planar.
template <class T>
void sum_tiles(const Simulation<T>& sim, std::size_t n, ThreadMemory<T>& memory,
               NodeFields<T>& node);

/// Nodes of positive mass.
template <class T>
std::int64_t count_nodes(const NodeFields<T>& node);

/// What stages 7 and 8 gather, from motion_of(node block). Whether v_i^{n+1} is finite.
template <class T, class F>
bool pack_all(Simulation<T>& sim, const F& motion_of) {
  const std::size_t blocks = sim.nodes.size();
  bool finite = true;
#pragma omp parallel for num_threads(sim.threads) reduction(&& : finite)
  for (std::size_t n = 0; n < blocks; ++n) {
    const NodeMotion<T>& motion = motion_of(n);
    finite = sim.kernels.pack_gathered(sim.constants, motion, sim.nodes.gathered(n)) && finite;
  }
  return finite;
}

}  // namespace firn::optimized
