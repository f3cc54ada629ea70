// SPDX-License-Identifier: BSD-3-Clause
/// Second half of the semi-implicit operator: a matrix per particle, scattered as the force of
/// stage 3. The form of the sums in x is that of p2g-inl.h, for 3 channels instead of 7.

#if defined(FIRN_OPTIMIZED_IMPLICIT_FORCE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_IMPLICIT_FORCE_INL_H_
#undef FIRN_OPTIMIZED_IMPLICIT_FORCE_INL_H_
#else
#define FIRN_OPTIMIZED_IMPLICIT_FORCE_INL_H_
#endif

#include "optimized/implicit/gradient-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// The z-rows of one particle's τ', and its weights in x and y.
template <class T>
struct HessianRows {
  Row<T> x[vector_rows<T>], y[vector_rows<T>], z[vector_rows<T>];
  const T* weights;  ///< see weights_of()
};

template <class T>
using VectorSums = RowSums<T, vector_row<T>>;

/// The z-rows of the particle in place i.
template <class T>
HWY_INLINE HessianRows<T> rows_of(const HessianScratch<T>& work, int i) {
  constexpr int C = channels<T>;
  const T* const record = work.records + i * hessian_record_size;
  HessianRows<T> rows;
  rows.weights = weights_of(work, i);
  const Row<T> w = each_node(record + hessian_record_w_z);
  const Row<T> dw = each_node(record + hessian_record_d_z);
  for (int r = 0; r < vector_rows<T>; ++r) {
    rows.x[r] = w * all_channels(record + hessian_record_x + r * C);
    rows.y[r] = w * all_channels(record + hessian_record_y + r * C);
    rows.z[r] = dw * all_channels(record + hessian_record_z + r * C);
  }
  return rows;
}

/// `count` rows from `first` on of n particles of one cell, at `nodes` y-nodes from j on; rows(p)
/// are those of particle p.
template <int first, int count, int nodes, class T, class Rows>
HWY_INLINE void accumulate_rows(const Rows& rows, int n, int j, T* sums) {
  constexpr int R = tile_row_size<T>, y_stride = moment_y<T>;
  VectorSums<T> a[nodes][count];
  for (int k = 0; k < nodes; ++k)
    for (int r = 0; r < count; ++r) a[k][r] = VectorSums<T>(sums + k * y_stride + r * R);
  for (int p = 0; p < n; ++p) {
    const HessianRows<T>& q = rows(p);
    const T* const of = q.weights;
    for (int k = 0; k < nodes; ++k) {
      const Row<T> w_y = weight(of, weight_y + j + k), d_y = weight(of, derivative_y + j + k);
      Row<T> b[count], D[count];
      for (int r = 0; r < count; ++r) {
        b[r] = w_y * q.z[first + r];
        D[r] = w_y * q.x[first + r];
      }
      for (int r = 0; r < count; ++r) b[r] = mul_add(d_y, q.y[first + r], b[r]);
      for (int r = 0; r < count; ++r) a[k][r].s0 = a[k][r].s0 + b[r];
      const Row<T> t = weight(of, weight_t);
      for (int r = 0; r < count; ++r) a[k][r].s1 = mul_add(t, b[r], a[k][r].s1) + D[r];
      const Row<T> w0 = weight(of, weight_x0);
      for (int r = 0; r < count; ++r) a[k][r].n0 = mul_add(w0, b[r], a[k][r].n0);
      const Row<T> d0 = weight(of, derivative_x0);
      for (int r = 0; r < count; ++r) a[k][r].n0 = mul_add(d0, D[r], a[k][r].n0);
      const Row<T> w3 = weight(of, weight_x3);
      for (int r = 0; r < count; ++r) a[k][r].n3 = mul_add(w3, b[r], a[k][r].n3);
      const Row<T> d3 = weight(of, derivative_x3);
      for (int r = 0; r < count; ++r) a[k][r].n3 = mul_add(d3, D[r], a[k][r].n3);
    }
  }
  for (int k = 0; k < nodes; ++k)
    for (int r = 0; r < count; ++r) a[k][r].store(sums + k * y_stride + r * R);
}

/// `count` particles of one cell, from place i on, onto the slab's sums
/// [y][n0, s0, s1, n3][row][z][channel].
template <class T>
HWY_INLINE void scatter_cell(const HessianScratch<T>& work, int i, int count, T* moments) {
  if constexpr (vector_rows<T> == 1) {  // 32 registers keep all 16 sums
    accumulate_rows<0, 1, stencil_nodes>([&](int p) HWY_ATTR { return rows_of(work, i + p); },
                                         count, 0, moments);
    return;
  }
  constexpr int batch = 16;  // 16 particles' rows fit beside the sums in L1
  constexpr int y_stride = moment_y<T>, R = tile_row_size<T>;
  HWY_ALIGN HessianRows<T> prepared[batch];
  const auto rows = [&](int p) HWY_ATTR -> const HessianRows<T>& { return prepared[p]; };
  for (; count > 0; count -= batch, i += batch) {
    const int n = count < batch ? count : batch;
    for (int k = 0; k < n; ++k) prepared[k] = rows_of(work, i + k);
    if constexpr (vector_rows<T> == 2 && HWY_MAX_BYTES == 64) {
      accumulate_rows<0, 2, 2>(rows, n, 0, moments);
      accumulate_rows<0, 2, 2>(rows, n, 2, moments + 2 * y_stride);
    } else {
      for (int j = 0; j < stencil_nodes; ++j) {
        T* const sums = moments + j * y_stride;
        accumulate_rows<0, 2, 1>(rows, n, j, sums);
        if constexpr (vector_rows<T> == 3) accumulate_rows<2, 1, 1>(rows, n, j, sums + 2 * R);
      }
    }
  }
}

/// The slab's sums as nodes, added to planes x … x+3 of the tile; see p2g-inl.h.
template <class T>
HWY_INLINE void finish_planes(const T* moments, int x, bool any, T* tile) {
  const Lanes<T> d;
  const auto two = hn::Set(d, static_cast<T>(2));
  for (int y = 0; y < tile_nodes; ++y) {
    const T* m = moments + y * moment_y<T>;
    T* to = tile + x * vector_plane<T> + y * vector_row<T>;
    for (int i = 0; i < vector_row<T>; i += lane_count<T>, m += lane_count<T>) {
      auto n0 = hn::Zero(d), n1 = n0, n2 = n0, n3 = n0;
      if (any) {
        n0 = hn::Load(d, m), n3 = hn::Load(d, m + 3 * vector_row<T>);
        const auto s0 = hn::Load(d, m + vector_row<T>), s1 = hn::Load(d, m + 2 * vector_row<T>);
        n2 = hn::NegMulAdd(two, n3, hn::Add(s1, n0));
        n1 = hn::Sub(hn::Sub(s0, n2), hn::Add(n0, n3));
      }
      if (x > 0) {
        n0 = hn::Add(n0, hn::Load(d, to + i));
        n1 = hn::Add(n1, hn::Load(d, to + vector_plane<T> + i));
        n2 = hn::Add(n2, hn::Load(d, to + 2 * vector_plane<T> + i));
      }
      hn::Store(n0, d, to + i);
      hn::Store(n1, d, to + vector_plane<T> + i);
      hn::Store(n2, d, to + 2 * vector_plane<T> + i);
      hn::Store(n3, d, to + 3 * vector_plane<T> + i);
    }
  }
}

/// The sum of a tile's nodes, in double. Nodes of one height are added up first, so that every
/// instruction set adds in the same order.
template <class T>
void tile_total(const T* tile, double* total) {
  constexpr int C = channels<T>, n = tile_row_size<T>, L = lane_count<double>;
  const Lanes<double> d;
  for (int r = 0; r < vector_rows<T>; ++r) {
    Vec<double> sums[n / L];
    for (auto& sum : sums) sum = hn::Zero(d);
    for (int xy = 0; xy < tile_nodes * tile_nodes; ++xy)
      for (int i = 0; i < n / L; ++i)
        sums[i] = hn::Add(sums[i], load_wide<double>(tile + (xy * vector_rows<T> + r) * n + i * L));
    alignas(cache_line) double by_height[n];
    for (int i = 0; i < n / L; ++i) hn::Store(sums[i], d, by_height + i * L);
    for (int c = 0; c < C && r * C + c < 3; ++c) {
      double& sum = total[r * C + c] = 0;
      for (int z = 0; z < tile_nodes; ++z) sum += by_height[z * C + c];
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
