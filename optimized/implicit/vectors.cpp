// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/implicit/vectors.hpp"

#include <algorithm>
#include <stdexcept>

namespace firn::optimized {

namespace {

/// The operator's tiles in type T, from the front of `memory`.
template <class T>
Pieces<T> tiles_in(std::span<std::byte> memory, std::size_t tile_size, std::size_t blocks) {
  return {Arena(memory).take<T>(tile_size * blocks), tile_size};
}

/// A vector field of each node block where stages 7 and 8 have (v_new, u).
template <class T, class S>
Pieces<T> gathered_in(const NodeStore<S>& nodes, std::size_t gathered_size) {
  const std::size_t room = nodes.gathered_bytes() / sizeof(T);
  if (gathered_size > room)
    throw std::logic_error("a vector field does not fit into the gathered fields' memory");
  return {Arena(nodes.lend_gathered()).take<T>(room * nodes.size()), room};
}

}  // namespace

template <class S>
SolveVectors<S> borrow_vectors(NodeStore<S>& nodes, std::size_t active_blocks,
                               const ImplicitKernels<S>& kernels) {
  const std::size_t n = nodes.size() * field_size;
  const std::size_t tile_in_float = kernels.hessian_in_float.tile_size;
  const std::size_t tile_in_double = kernels.hessian_in_double.tile_size;
  const std::size_t tile_in_S = kernels.template hessian<S>().tile_size;
  const std::size_t tiles_in_S = to_cache_lines(active_blocks * tile_in_S * sizeof(S));
  const std::size_t tiles_in_double =
      to_cache_lines(active_blocks * tile_in_double * sizeof(double));
  const std::size_t front = n * (sizeof(double) + sizeof(S));
  const std::size_t back = std::max(tiles_in_S + 4 * n * sizeof(S), tiles_in_double);

  SolveVectors<S> vectors;
  Arena arena(nodes.lend_tiles(front + back));
  vectors.v = {arena.take<double>(n)};
  vectors.z = {arena.take<S>(n)};
  vectors.in_float.tiles = tiles_in<float>(arena.rest(), tile_in_float, active_blocks);
  vectors.in_double.tiles = tiles_in<double>(arena.rest(), tile_in_double, active_blocks);
  Arena of_minres(arena.rest().subspan(tiles_in_S));
  for (FieldVector<S>* field : {&vectors.z_last, &vectors.w_last, &vectors.w, &vectors.d})
    *field = {of_minres.take<S>(n)};
  vectors.in_float.gathered = gathered_in<float>(nodes, kernels.hessian_in_float.gathered_size);
  vectors.in_double.gathered = gathered_in<double>(nodes, kernels.hessian_in_double.gathered_size);
  return vectors;
}

template SolveVectors<float> borrow_vectors(NodeStore<float>&, std::size_t,
                                            const ImplicitKernels<float>&);
template SolveVectors<double> borrow_vectors(NodeStore<double>&, std::size_t,
                                             const ImplicitKernels<double>&);

}  // namespace firn::optimized
