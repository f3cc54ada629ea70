// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/drivers/volumes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "optimized/drivers/finite.hpp"
#include "optimized/drivers/parallel.hpp"

namespace firn::optimized {

namespace {

/// N at the nodes −1, 0, 1, 2 around an offset t, outer branch factored.
std::array<double, stencil_nodes> weights(double t) {
  const double o = 1 - t;
  return {o * o * o / 6, 2.0 / 3 - t * t + t * t * t / 2, 2.0 / 3 - o * o + o * o * o / 2,
          t * t * t / 6};
}

/// m_i of the nodes around a block.
struct TileMasses {
  double m[tile_nodes][tile_nodes][tile_nodes];
};

template <class T>
TileMasses masses_around(const NodeStore<T>& nodes, const NodeIndex& b) {
  TileMasses tile;
  for (int x = 0; x < tile_nodes; ++x)
    for (int y = 0; y < tile_nodes; ++y)
      for (int z = 0; z < tile_nodes; ++z) {
        const auto at = nodes.find(
            {block_cells * b.i - 1 + x, block_cells * b.j - 1 + y, block_cells * b.k - 1 + z});
        tile.m[x][y][z] = static_cast<double>(nodes.fields(at.block).m[at.node]);
      }
  return tile;
}

/// ρ_p0 = Σ_i m_i w_ip / h³ of particle i of a block.
template <class T>
double density(const ParticleStore<T>& particles, const Block<T>& block, std::size_t i,
               const TileMasses& tile) {
  const double h3 = std::pow(particles.lattice().spacing(), 3);
  const std::int32_t b[3] = {block.b.i, block.b.j, block.b.k};
  int first[3];
  std::array<double, stencil_nodes> w[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double x =
        particles.grid_position(block, i, axis) - block_cells * static_cast<double>(b[axis]);
    first[axis] = std::min(static_cast<int>(x), block_cells - 1);
    w[axis] = weights(x - first[axis]);
  }
  double rho = 0;
  for (std::size_t x = 0; x < stencil_nodes; ++x)
    for (std::size_t y = 0; y < stencil_nodes; ++y)
      for (std::size_t z = 0; z < stencil_nodes; ++z)
        rho += tile.m[first[0] + x][first[1] + y][first[2] + z] * w[0][x] * w[1][y] * w[2][z] / h3;
  return rho;
}

}  // namespace

template <class T>
void estimate_volumes(Simulation<T>& sim) {
  if (sim.volumes != Volumes::unknown && sim.skips.volumes) return;
  const ParticleStore<T>& particles = sim.particles;
  for_each_active_block(sim, [&](std::size_t a, ThreadMemory<T>&) {
    const Block<T>& block = particles.active_block(a);
    const TileMasses tile = masses_around(sim.nodes, block.b);
    for (std::size_t i = 0; i < block.count; ++i) {
      const double rho = density(particles, block, i, tile);
      T& V_0 = particles.value(block, i, slot_V_0);
      if (V_0 == 0)
        V_0 = static_cast<T>(static_cast<double>(particles.value(block, i, slot_m)) / rho);
    }
  });
  if (sim.volumes != Volumes::unknown) return;
  sim.volumes = Volumes::estimated;
  sim.stress_stale = true;
  require_finite_particles(sim, Stage::volumes, slot_V_0, 1, "volume is not finite");
}

template void estimate_volumes(Simulation<float>&);
template void estimate_volumes(Simulation<double>&);

}  // namespace firn::optimized
