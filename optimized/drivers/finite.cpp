// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/drivers/finite.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "firn/error.hpp"

namespace firn::optimized {

namespace {

/// Place of a node among those of positive mass in (i,j,k) order.
template <class T>
std::int64_t place_in_order(const NodeStore<T>& nodes, const NodeIndex& mine) {
  std::int64_t before = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n)
    for (int k = 0; k < nodes_per_block; ++k)
      if (nodes.fields(n).m[k] > 0 && nodes.index(n, k) < mine) ++before;
  return before;
}

}  // namespace

template <class T>
void require_finite_nodes(const Simulation<T>& sim, Stage stage,
                          std::type_identity_t<NodeVectorOf<T>> field) {
  for (std::size_t n = 0; n < sim.nodes.size(); ++n) {
    const NodeFields<T>& node = sim.nodes.fields(n);
    for (int k = 0; k < nodes_per_block; ++k)
      for (int a = 0; a < 3; ++a)
        if (!std::isfinite((node.*field)[a][k]) || !std::isfinite(node.m[k])) {
          const NodeIndex at = sim.nodes.index(n, k);
          throw SimulationError(stage, SimulationError::Subject::node,
                                place_in_order(sim.nodes, at),
                                std::string(stage == Stage::grid_forces ? "force" : "velocity") +
                                    " is not finite at node (" + std::to_string(at.i) + ", " +
                                    std::to_string(at.j) + ", " + std::to_string(at.k) + ")");
        }
  }
}

template <class T>
void require_finite_particles(const Simulation<T>& sim, Stage stage, int slot, int count,
                              const char* what) {
  constexpr std::size_t nobody = std::numeric_limits<std::size_t>::max();
  std::size_t first = nobody;
  for (const BlockNumber number : sim.particles.active()) {
    const Block<T>& block = sim.particles.block(number);
    for (std::size_t i = 0; i < block.count; ++i)
      for (int s = slot; s < slot + count; ++s)
        if (!std::isfinite(sim.particles.value(block, i, s)))
          first = std::min(first, sim.particles.index(block, i));
  }
  if (first != nobody)
    throw SimulationError(stage, SimulationError::Subject::particle,
                          static_cast<std::int64_t>(first), what);
}

template void require_finite_nodes(const Simulation<float>&, Stage, NodeVectorOf<float>);
template void require_finite_nodes(const Simulation<double>&, Stage, NodeVectorOf<double>);
template void require_finite_particles(const Simulation<float>&, Stage, int, int, const char*);
template void require_finite_particles(const Simulation<double>&, Stage, int, int, const char*);

}  // namespace firn::optimized
