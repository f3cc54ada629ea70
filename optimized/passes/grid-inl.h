// SPDX-License-Identifier: BSD-3-Clause
/// Stages 1, 3, 4 and 6 on the 4×4×4 nodes of a node block. Collisions (stage 5)
/// come between and are plain code (contact.hpp).

#if defined(FIRN_OPTIMIZED_GRID_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_GRID_INL_H_
#undef FIRN_OPTIMIZED_GRID_INL_H_
#else
#define FIRN_OPTIMIZED_GRID_INL_H_
#endif

#include "optimized/passes/position-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// A region of a tile of `rows` rows per stencil row added to a node block's sums, which are
/// laid out [row][x][y][z][channel], so that planar() can take a row's channels apart. The sums
/// may be wider than the tile.
template <class T, int rows, class Sum = T>
void add_tile(const T* tile, const Region& region, Sum* sums) {
  const Lanes<Sum> d;
  constexpr int R = tile_row_size<T>;
  constexpr int xy_row = row_size<T>;
  // Tile nodes 4 … 6 are followed by a 7th of zeros: the whole row may be added. Tile nodes
  // 0 … 2 alone, which the end of a period cuts off, are followed by another node.
  constexpr int low = block_cells, high = tile_nodes - low;  // nodes of either node block
  const bool whole_row = region.node[2] == 0 && ((region.tile[2] == 0 && region.size[2] == low) ||
                                                 (region.tile[2] == low && region.size[2] == high));
  for (int x = 0; x < region.size[0]; ++x)
    for (int y = 0; y < region.size[1]; ++y) {
      const T* from = tile + region.tile[2] * channels<T> +
                      ((x + region.tile[0]) * tile_nodes + y + region.tile[1]) * rows * R;
      Sum* to = sums + (block_cells * (x + region.node[0]) + y + region.node[1]) * xy_row +
                region.node[2] * channels<T>;
      for (int r = 0; r < rows; ++r, from += R, to += rows_per_block * xy_row) {
        if (HWY_LIKELY(whole_row)) {
          for (int i = 0; i < xy_row; i += lane_count<Sum>)
            hn::StoreU(hn::Add(hn::LoadU(d, to + i), load_wide<Sum>(from + i)), d, to + i);
        } else {
          for (int i = 0; i < region.size[2] * channels<T>; ++i) to[i] += static_cast<Sum>(from[i]);
        }
      }
    }
}

/// C planar arrays of a value per node from one row, channel fastest.
template <class T, int C = channels<T>>
HWY_INLINE void separate(const T* row, T* const* to) {
  const Lanes<T> d;
  for (int i = 0; i < nodes_per_block; i += lane_count<T>) {
    Vec<T> a, b, c, e;
    if constexpr (C == 1) {
      hn::Store(hn::Load(d, row + i), d, to[0] + i);
    } else if constexpr (C == 2) {
      hn::LoadInterleaved2(d, row + 2 * i, a, b);
      hn::Store(a, d, to[0] + i);
      hn::Store(b, d, to[1] + i);
    } else {
      hn::LoadInterleaved4(d, row + 4 * i, a, b, c, e);
      hn::Store(a, d, to[0] + i);
      hn::Store(b, d, to[1] + i);
      hn::Store(c, d, to[2] + i);
      hn::Store(e, d, to[3] + i);
    }
  }
}

/// The other way round.
template <class T>
HWY_INLINE void interleave(const T* const* from, T* row) {
  const Lanes<T> d;
  for (int i = 0; i < nodes_per_block; i += lane_count<T>) {
    const auto channel = [&](int c) HWY_ATTR { return hn::Load(d, from[c] + i); };
    if constexpr (channels<T> == 1)
      hn::Store(channel(0), d, row + i);
    else if constexpr (channels<T> == 2)
      hn::StoreInterleaved2(channel(0), channel(1), d, row + 2 * i);
    else
      hn::StoreInterleaved4(channel(0), channel(1), channel(2), channel(3), d, row + 4 * i);
  }
}

/// Leaves zeros behind for the sums of the next node block.
template <class T>
void planar(T* sums, NodeFields<T>& node) {
  alignas(cache_line) T unused[nodes_per_block];
  T* const to[values_per_node] = {node.momentum[0], node.momentum[1], node.momentum[2], node.m,
                                  node.f[0],        node.f[1],        node.f[2],        unused};
  const Lanes<T> d;
  for (int r = 0; r < tile_rows<T>; ++r, sums += rows_per_block * row_size<T>) {
    separate(sums, to + r * channels<T>);
    for (int i = 0; i < rows_per_block * row_size<T>; i += lane_count<T>)
      hn::Store(hn::Zero(d), d, sums + i);
  }
}

/// `value` where there is mass, 0 elsewhere.
template <class T>
HWY_INLINE Vec<T> where_mass(const Vec<T>& m, const Vec<T>& value) {
  const Lanes<T> d;
  return hn::IfThenElseZero(hn::Gt(m, hn::Zero(d)), value);
}

/// Divided, not multiplied by a reciprocal: 1/m_i of a light node may overflow.
template <class T>
void node_velocities(NodeFields<T>& node) {
  const Lanes<T> d;
  for (int i = 0; i < nodes_per_block; i += lane_count<T>) {
    const auto m = hn::Load(d, node.m + i);
    for (int a = 0; a < 3; ++a)
      hn::Store(where_mass<T>(m, hn::Div(hn::Load(d, node.momentum[a] + i), m)), d, node.v[a] + i);
  }
}

/// f_i = −(1/h) Σ A ∂w, where planar() left Σ A ∂w in node.f.
template <class T>
void node_forces(const StepConstants<T>& step, NodeFields<T>& node) {
  const Lanes<T> d;
  const auto factor = hn::Set(d, step.minus_inv_h);
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < nodes_per_block; i += lane_count<T>)
      hn::Store(hn::Mul(hn::Load(d, node.f[a] + i), factor), d, node.f[a] + i);
}

template <class T>
void node_velocities_star(const StepConstants<T>& step, NodeFields<T>& node) {
  const Lanes<T> d;
  const auto dt = hn::Set(d, step.dt);
  for (int i = 0; i < nodes_per_block; i += lane_count<T>) {
    const auto m = hn::Load(d, node.m + i);
    for (int a = 0; a < 3; ++a) {
      const auto acceleration = hn::Div(hn::Load(d, node.f[a] + i), m);
      const auto v = hn::Add(hn::Load(d, node.v[a] + i), hn::Set(d, step.gravity_dt[a]));
      hn::Store(where_mass<T>(m, hn::MulAdd(dt, acceleration, v)), d, node.v_star[a] + i);
    }
  }
}

template <class T>
HWY_INLINE bool all_finite(const T (&field)[3][nodes_per_block]) {
  const Lanes<T> d;
  auto sum = hn::Zero(d);  // 0·x is 0 or NaN
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < nodes_per_block; i += lane_count<T>)
      sum = hn::MulAdd(hn::Load(d, field[a] + i), hn::Zero(d), sum);
  return hn::AllTrue(d, hn::Eq(sum, hn::Zero(d)));
}

/// v^{n+1} and u = v^{n+1} − α vⁿ, interleaved as the gather reads them:
/// [x][y][row][z][channel] with the six channels (v_new, u). Whether v_new is finite.
template <class T>
bool pack_gathered(const StepConstants<T>& step, const NodeMotion<T>& node, T* gathered) {
  const Lanes<T> d;
  constexpr int C = channels<T>;
  alignas(cache_line) T u[3][nodes_per_block];
  const auto flip = hn::Set(d, step.flip);
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < nodes_per_block; i += lane_count<T>)
      hn::Store(hn::NegMulAdd(flip, hn::Load(d, node.v[a] + i), hn::Load(d, node.v_star[a] + i)), d,
                u[a] + i);
  const T* const from[values_per_node] = {node.v_star[0], node.v_star[1], node.v_star[2], u[0],
                                          u[1],           u[2],           u[2],           u[2]};
  for (int r = 0; r < gather_rows<T>; ++r) {
    alignas(cache_line) T row[rows_per_block * row_size<T>];
    interleave(from + r * C, row);
    for (int xy = 0; xy < rows_per_block; ++xy)
      store_row(load_row(row + xy * row_size<T>),
                gathered + (xy * gather_rows<T> + r) * row_size<T>);
  }
  return all_finite(node.v_star);
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
