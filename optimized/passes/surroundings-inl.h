// SPDX-License-Identifier: BSD-3-Clause
/// The node values around a block, 7×7×8 of them, put together from its node blocks: what
/// stages 7 and 8 gather from, and what the semi-implicit operator of step 6 gathers from.
/// A field has `rows` stencil rows per node.

#if defined(FIRN_OPTIMIZED_SURROUNDINGS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_SURROUNDINGS_INL_H_
#undef FIRN_OPTIMIZED_SURROUNDINGS_INL_H_
#else
#define FIRN_OPTIMIZED_SURROUNDINGS_INL_H_
#endif

#include "optimized/passes/row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// From the 8 node blocks around the block.
template <class T, int rows>
void load_local(const T* const gathered[tile_corners], T* local) {
  constexpr int R = tile_row_size<T>;
  for (int x = 0; x < tile_nodes; ++x)
    for (int y = 0; y < tile_nodes; ++y) {
      constexpr int n = block_cells;
      const int source =
          4 * (x / n) + 2 * (y / n);  // the corner; the one above it in z is the next
      const int offset = (x % n * n + y % n) * rows * row_size<T>;
      const T* low = gathered[source] + offset;
      const T* high = gathered[source + 1] + offset;
      T* to = local + (x * tile_nodes + y) * rows * R;
      for (int r = 0; r < rows; ++r) {
        store_row(load_row(low + r * row_size<T>), to + r * R);
        store_row(load_row(high + r * row_size<T>), to + r * R + row_size<T>);
      }
    }
}

/// The same region by region, where a periodic axis cuts node blocks.
template <class T, int rows>
void load_region(const T* gathered, const Region& region, T* local) {
  constexpr int C = channels<T>;
  for (int x = 0; x < region.size[0]; ++x)
    for (int y = 0; y < region.size[1]; ++y)
      for (int r = 0; r < rows; ++r) {
        const int xy = block_cells * (x + region.node[0]) + y + region.node[1];
        const T* from = gathered + (xy * rows + r) * row_size<T> + region.node[2] * C;
        T* to = local + region.tile[2] * C +
                (((x + region.tile[0]) * tile_nodes + y + region.tile[1]) * rows + r) *
                    tile_row_size<T>;
        for (int i = 0; i < region.size[2] * C; ++i) to[i] = from[i];
      }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // include guard
