// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/implicit/defect.hpp"

namespace firn::optimized {

std::array<int, 3> anchor_of(const ParticleStore<double>& particles, const Block<double>& block) {
  std::size_t heaviest = 0;
  for (std::size_t i = 1; i < block.count; ++i)
    if (particles.value(block, i, slot_m) > particles.value(block, heaviest, slot_m)) heaviest = i;
  std::array<int, 3> node{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = particles.value(block, heaviest, slot_x + axis);
    node[axis] = 1 + static_cast<int>(x + 0.5);
  }
  return node;
}

int node_in_region(const Region& region, const std::array<int, 3>& tile_node) {
  int node = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int k = tile_node[axis] - region.tile[axis];
    if (k < 0 || k >= region.size[axis]) return -1;
    node = block_cells * node + region.node[axis] + k;
  }
  return node;
}

}  // namespace firn::optimized
