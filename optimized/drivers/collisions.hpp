// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Stages 5 and 9 of one block: which colliders it may touch, and what they do.

#include <vector>

#include "optimized/drivers/simulation.hpp"

namespace firn::optimized {

/// Stage 5 of node block n. In semi-implicit scenes notes the directions that contact leaves free.
template <class T>
void collide_nodes(Simulation<T>& sim, std::size_t n, std::vector<std::size_t>& colliders,
                   NodeFields<T>& node);

/// The colliders that particles of a block may touch.
template <class T>
void find_colliders(const Simulation<T>& sim, const Block<T>& block,
                    std::vector<std::size_t>& colliders);

/// Stage 9 of one block, with the colliders that were found.
template <class T>
void collide_particles(const Simulation<T>& sim, const Block<T>& block,
                       const std::vector<std::size_t>& colliders);

}  // namespace firn::optimized
