// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What step 6 owns from one step to the next. The vectors of a solve are not among it: they lie in
/// memory that the explicit step lends (vectors.hpp).

#include <algorithm>
#include <tuple>
#include <type_traits>
#include <vector>

#include "optimized/implicit/defect.hpp"
#include "optimized/implicit/free_directions.hpp"
#include "optimized/implicit/linearization.hpp"
#include "optimized/store/node_store.hpp"

namespace firn::optimized {

/// Where a thread adds up the tiles around a node block: a vector field, interleaved in up to 4
/// channels, and planar.
template <class Field>
struct alignas(cache_line) FieldSums {
  Field interleaved[vector_values * nodes_per_block], planar[field_size];
};

/// One for each type that FieldType<T, S> may be; std::get<FieldSums<Field>>() chooses.
template <class S>
using ThreadSums =
    std::conditional_t<std::is_same_v<S, float>, std::tuple<FieldSums<float>, FieldSums<double>>,
                       std::tuple<FieldSums<double>>>;

template <class S>
struct ImplicitMemory {
  // Left by the stages before.
  AlignedArray<NodeMotion<S>> motion;  ///< m, vⁿ and v* by node block; v^{n+1} after the solve
  FreeDirections<S> free;

  // Of a solve.
  Linearization<S> linearization;
  std::vector<Defect> defects;      ///< of each active block, if S is double
  std::vector<ThreadSums<S>> sums;  ///< of each thread
  AlignedArray<double> partial;     ///< of each node block, in sums over all

  // Between two stages only.
  AlignedArray<BlockField<S>> v_star;  ///< what the solve started from

  /// Room for the nodes; all their directions are free.
  void release(std::size_t node_blocks) {
    motion.require(node_blocks, node_blocks / 8);
    free.release(node_blocks);
  }

  void remember_v_star(const NodeStore<S>& nodes) {
    v_star.require(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n)
      std::copy_n(&nodes.fields(n).v_star[0][0], field_size, &v_star[n].v[0][0]);
  }

  std::size_t bytes() const {
    return motion.bytes() + free.bytes() + linearization.bytes() +
           defects.capacity() * sizeof(Defect) + sums.capacity() * sizeof(ThreadSums<S>) +
           partial.bytes() + v_star.bytes();
  }
};

}  // namespace firn::optimized
