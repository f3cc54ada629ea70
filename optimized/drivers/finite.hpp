// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What stage by stage is found not to be finite, named by particle or node.

#include <type_traits>

#include "optimized/drivers/simulation.hpp"

namespace firn::optimized {

/// A vector field of a node block, &NodeFields<T>::v for example.
template <class T>
using NodeVectorOf = const T (NodeFields<T>::*)[3][nodes_per_block];

/// Throws SimulationError for the first node whose mass or `field` is not finite; its index is the
/// node's place among those of positive mass in (i,j,k) order.
template <class T>
void require_finite_nodes(const Simulation<T>& sim, Stage stage,
                          std::type_identity_t<NodeVectorOf<T>> field);

/// Throws SimulationError, with text `what`, for the particle with the smallest index whose values
/// in slots `slot` … `slot` + `count` − 1 are not all finite.
template <class T>
void require_finite_particles(const Simulation<T>& sim, Stage stage, int slot, int count,
                              const char* what);

}  // namespace firn::optimized
