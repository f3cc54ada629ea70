// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Inner forces add up to 0, exactly or to the roundoff of the type in which they are scattered; if
/// that is narrower than the fields', momentum would drift. What a tile's forces lack is given to
/// one of its nodes. All particles of a block share nodes, so that this is one of their own body's
/// (but for particles less than some 1e-6 h from a plane of nodes, whose outer weights vanish).

#include <array>

#include "optimized/store/particle_store.hpp"

namespace firn::optimized {

/// Of each active block.
struct Defect {
  std::array<int, 3> anchor;  ///< the node of the tile that receives it
  double total[3];            ///< what the tile's forces add up to
};

/// The node of a block's tile that its heaviest particle is nearest to, for positions in double.
std::array<int, 3> anchor_of(const ParticleStore<double>& particles, const Block<double>& block);

/// Where a node block has a tile's node; −1 if it does not.
int node_in_region(const Region& region, const std::array<int, 3>& tile_node);

}  // namespace firn::optimized
