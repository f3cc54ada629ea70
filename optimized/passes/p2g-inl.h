// SPDX-License-Identifier: BSD-3-Clause
/// Stages 1 and 3, P2G: m_i = Σ m_p w_ip, (m v)_i = Σ m_p v_p w_ip and
/// Σ_p (V P Fᵀ)_p ∂w_ip, of one block onto its own tile of 7×7×7 nodes.
///
/// All particles of a cell are accumulated in registers; memory is touched once
/// per cell and stencil row. In x a row does not accumulate its 4 nodes but
///   n0 = Σ w0 b − …, n3 = Σ w3 b + …   the outer nodes, and
///   s0 = Σ b,        s1 = Σ (t b + D)   zeroth and first moment,
/// where b is what a node weight multiplies and D what its x-derivative does. With
/// Σ w = 1 and Σ a w_a = t over a = −1 … 2 the inner nodes follow once per block:
///   n2 = s1 + n0 − 2 n3,   n1 = s0 − n0 − n2 − n3.
/// 7 operations a row instead of 8, and unlike the full set of moments Σ tᵃ b it
/// keeps the relative accuracy of light nodes: n0 and n3 are sums of their own
/// terms, while the inner weights are never below 1/6.

#if defined(FIRN_OPTIMIZED_P2G_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_P2G_INL_H_
#undef FIRN_OPTIMIZED_P2G_INL_H_
#else
#define FIRN_OPTIMIZED_P2G_INL_H_
#endif

#include "optimized/passes/records-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// Particles of a cell whose z-rows are prepared together: 16 keep them in L1.
inline constexpr int batch_size = 16;

/// The z-rows of one particle: what is left to multiply by weights in y and x.
template <class T>
struct ParticleRows {
  Row<T> mass[mass_rows<T>];  // w_z (m v, m)
  Row<T> x[force_rows<T>];    // w_z τ_·x
  Row<T> y[force_rows<T>];    // w_z τ_·y
  Row<T> z[force_rows<T>];    // w'_z τ_·z
};

/// From one y to the next in a slab's sums, [y][n0, s0, s1, n3][row][z][channel].
template <class T>
inline constexpr int tile_moment_y = sums_in_x* tile_rows<T>* tile_row_size<T>;

template <class T>
using TileSums = RowSums<T, tile_rows<T> * tile_row_size<T>>;

template <class T>
HWY_INLINE void prepare(const ZKernel<T>& kernel, const T* record, ParticleRows<T>& rows) {
  constexpr int C = channels<T>;
  Row<T> w, dw;
  kernel.weights(record + record_r, w, dw);
  for (int r = 0; r < mass_rows<T>; ++r)
    rows.mass[r] = w * all_channels(record + record_momentum + r * C);
  for (int r = 0; r < force_rows<T>; ++r) {
    rows.x[r] = w * all_channels(record + record_tau_x + r * C);
    rows.y[r] = w * all_channels(record + record_tau_y + r * C);
    rows.z[r] = dw * all_channels(record + record_tau_z + r * C);
  }
}

/// Rows first … first+count−1 of mass and momentum, at the y-node with weight w_y[j].
template <int first, int count, class T>
HWY_INLINE void accumulate_mass(const ParticleRows<T>* rows, const T* record, int n, int j,
                                T* sums) {
  TileSums<T> a[2] = {TileSums<T>(sums), TileSums<T>(sums + (count - 1) * tile_row_size<T>)};
  FIRN_UNROLL_TWICE
  for (int p = 0; p < n; ++p, record += record_size) {
    const Row<T> w_y = all(record + record_w_y + j), t = all(record + record_t);
    const Row<T> w0 = all(record + record_w_x0), w3 = all(record + record_w_x3);
    for (int r = 0; r < count; ++r) {
      const Row<T> b = w_y * rows[p].mass[first + r];
      a[r].s0 = a[r].s0 + b;
      a[r].s1 = mul_add(t, b, a[r].s1);
      a[r].n0 = mul_add(w0, b, a[r].n0);
      a[r].n3 = mul_add(w3, b, a[r].n3);
    }
  }
  for (int r = 0; r < count; ++r) a[r].store(sums + r * tile_row_size<T>);
}

/// The same for the force: b = w_y τ_·z w'_z + w'_y τ_·y w_z, D = w_y τ_·x w_z.
template <int first, int count, class T>
HWY_INLINE void accumulate_force(const ParticleRows<T>* rows, const T* record, int n, int j,
                                 T* sums) {
  TileSums<T> a[2] = {TileSums<T>(sums), TileSums<T>(sums + (count - 1) * tile_row_size<T>)};
  FIRN_UNROLL_TWICE
  for (int p = 0; p < n; ++p, record += record_size) {
    // Weight by weight, not row by row: at most two weights are alive at a time, and
    // 8 sums, 2 b and 2 D fit into 16 registers beside them.
    const Row<T> w_y = all(record + record_w_y + j), d_y = all(record + record_d_y + j);
    Row<T> b[count], D[count];
    for (int r = 0; r < count; ++r) {
      b[r] = w_y * rows[p].z[first + r];
      D[r] = w_y * rows[p].x[first + r];
    }
    for (int r = 0; r < count; ++r) b[r] = mul_add(d_y, rows[p].y[first + r], b[r]);
    for (int r = 0; r < count; ++r) a[r].s0 = a[r].s0 + b[r];
    const Row<T> t = all(record + record_t);
    for (int r = 0; r < count; ++r) a[r].s1 = mul_add(t, b[r], a[r].s1) + D[r];
    const Row<T> w0 = all(record + record_w_x0);
    for (int r = 0; r < count; ++r) a[r].n0 = mul_add(w0, b[r], a[r].n0);
    const Row<T> d0 = all(record + record_d_x0);
    for (int r = 0; r < count; ++r) a[r].n0 = mul_add(d0, D[r], a[r].n0);
    const Row<T> w3 = all(record + record_w_x3);
    for (int r = 0; r < count; ++r) a[r].n3 = mul_add(w3, b[r], a[r].n3);
    const Row<T> d3 = all(record + record_d_x3);
    for (int r = 0; r < count; ++r) a[r].n3 = mul_add(d3, D[r], a[r].n3);
  }
  for (int r = 0; r < count; ++r) a[r].store(sums + r * tile_row_size<T>);
}

/// Mass, momentum and force together at the y-nodes j and j+1, where a row holds all four
/// channels: 32 registers keep the 16 sums, and what belongs to x is read once for two nodes.
template <bool with_force, class T>
HWY_INLINE void accumulate_two_nodes(const ParticleRows<T>* rows, const T* record, int n, int j,
                                     T* sums) {
  constexpr int R = tile_row_size<T>;
  TileSums<T> mass[2] = {TileSums<T>(sums), TileSums<T>(sums + tile_moment_y<T>)};
  TileSums<T> force[2] = {TileSums<T>(sums + R), TileSums<T>(sums + tile_moment_y<T> + R)};
  for (int p = 0; p < n; ++p, record += record_size) {
    const Row<T> t = all(record + record_t);
    const Row<T> w0 = all(record + record_w_x0), w3 = all(record + record_w_x3);
    const Row<T> d0 = all(record + record_d_x0), d3 = all(record + record_d_x3);
    for (int k = 0; k < 2; ++k) {
      const Row<T> w_y = all(record + record_w_y + j + k);
      const Row<T> c = w_y * rows[p].mass[0];
      mass[k].s0 = mass[k].s0 + c;
      mass[k].s1 = mul_add(t, c, mass[k].s1);
      mass[k].n0 = mul_add(w0, c, mass[k].n0);
      mass[k].n3 = mul_add(w3, c, mass[k].n3);
      if constexpr (with_force) {
        const Row<T> D = w_y * rows[p].x[0];
        const Row<T> b =
            mul_add(all(record + record_d_y + j + k), rows[p].y[0], w_y * rows[p].z[0]);
        force[k].s0 = force[k].s0 + b;
        force[k].s1 = mul_add(t, b, force[k].s1) + D;
        force[k].n0 = mul_add(d0, D, mul_add(w0, b, force[k].n0));
        force[k].n3 = mul_add(d3, D, mul_add(w3, b, force[k].n3));
      }
    }
  }
  for (int k = 0; k < 2; ++k) {
    mass[k].store(sums + k * tile_moment_y<T>);
    if constexpr (with_force) force[k].store(sums + k * tile_moment_y<T> + R);
  }
}

/// All rows of the particles of one cell; those of the force only where there is stress.
template <bool with_force, class T>
HWY_INLINE void accumulate(const ParticleRows<T>* rows, const T* record, int n, T* sums) {
  constexpr int R = tile_row_size<T>;
  if constexpr (mass_rows<T> == 1) {
    accumulate_two_nodes<with_force>(rows, record, n, 0, sums);
    accumulate_two_nodes<with_force>(rows, record, n, 2, sums + 2 * tile_moment_y<T>);
  } else {
    for (int j = 0; j < stencil_nodes; ++j, sums += tile_moment_y<T>) {
      if constexpr (mass_rows<T> == 2) {
        accumulate_mass<0, 2>(rows, record, n, j, sums);
        if constexpr (with_force) accumulate_force<0, 2>(rows, record, n, j, sums + 2 * R);
      } else {
        accumulate_mass<0, 2>(rows, record, n, j, sums);
        accumulate_mass<2, 2>(rows, record, n, j, sums + 2 * R);
        if constexpr (with_force) {
          accumulate_force<0, 2>(rows, record, n, j, sums + 4 * R);
          accumulate_force<2, 1>(rows, record, n, j, sums + 6 * R);
        }
      }
    }
  }
}

/// What the rest of the scatter will touch, asked for cell by cell while the arithmetic
/// goes on: the planes of the tile that this slab is added to, and the particles of the
/// block that comes next.
template <class T>
struct ScatterAhead {
  const T* planes;  ///< of the tile, `lines` cache lines that come into use
  int lines;
  const BlockView<T>* next;  ///< nullptr: none
  int slots, x;              ///< the slab

  HWY_INLINE void prefetch(int c) const {
    for (int k = lines * c / cells_per_slab; k < lines * (c + 1) / cells_per_slab; ++k)
      hwy::Prefetch(planes + k * chunk_lanes<T>);
    if (next == nullptr) return;
    const int chunks = (next->count + chunk_lanes<T> - 1) / chunk_lanes<T>;
    constexpr int parts = cells_per_block;
    const int part = cells_per_slab * x + c;
    for (int k = chunks * part / parts; k < chunks * (part + 1) / parts; ++k) {
      prefetch_chunk(*next, slots, k * chunk_lanes<T>, slot_x, slot_v + 3);
      prefetch_chunk(*next, slots, k * chunk_lanes<T>, slot_tau, slot_m + 1);
    }
  }
};

/// The 16 cells at one x onto the slab's sums: [y][n0, s0, s1, n3][row][z][channel].
template <bool with_force, class T>
HWY_INLINE void accumulate_slab(const ZKernel<T>& kernel, const int* begin, const T* records,
                                T* moments, const ScatterAhead<T>& ahead) {
  HWY_ALIGN ParticleRows<T> rows[batch_size];
  for (int c = 0; c < cells_per_slab; ++c) {
    ahead.prefetch(c);
    for (int p = begin[c]; p < begin[c + 1]; p += batch_size) {
      const int n = begin[c + 1] - p < batch_size ? begin[c + 1] - p : batch_size;
      const T* record = records + p * record_size;
      for (int k = 0; k < n; ++k) prepare(kernel, record + k * record_size, rows[k]);
      accumulate<with_force>(
          rows, record, n,
          moments + c / block_cells * tile_moment_y<T> + c % block_cells * channels<T>);
    }
  }
}

/// The slab's sums as nodes, added to planes x … x+3 of the tile. The slab at
/// x = 0 is the first: it sets planes 0 … 2 and every slab sets its last plane.
template <class T>
HWY_INLINE void finish_slab(const T* moments, int x, bool any, T* tile) {
  constexpr int plane_row = tile_rows<T> * tile_row_size<T>;
  constexpr int plane = tile_nodes * plane_row;
  const Lanes<T> d;
  const auto two = hn::Set(d, static_cast<T>(2));
  for (int y = 0; y < tile_nodes; ++y) {
    const T* m = moments + y * tile_moment_y<T>;
    T* to = tile + x * plane + y * plane_row;
    for (int i = 0; i < plane_row; i += lane_count<T>) {
      auto n0 = hn::Zero(d), n1 = n0, n2 = n0, n3 = n0;
      if (any) {
        n0 = hn::Load(d, m + i), n3 = hn::Load(d, m + 3 * plane_row + i);
        const auto s0 = hn::Load(d, m + plane_row + i), s1 = hn::Load(d, m + 2 * plane_row + i);
        n2 = hn::NegMulAdd(two, n3, hn::Add(s1, n0));
        n1 = hn::Sub(hn::Sub(s0, n2), hn::Add(n0, n3));
      }
      if (x > 0) {
        n0 = hn::Add(n0, hn::Load(d, to + i));
        n1 = hn::Add(n1, hn::Load(d, to + plane + i));
        n2 = hn::Add(n2, hn::Load(d, to + 2 * plane + i));
      }
      hn::Store(n0, d, to + i);
      hn::Store(n1, d, to + plane + i);
      hn::Store(n2, d, to + 2 * plane + i);
      hn::Store(n3, d, to + 3 * plane + i);
    }
  }
}

template <class T>
void scatter(const BlockView<T>& block, const BlockView<T>* next, const StepConstants<T>& step,
             const Workspace<T>& work, T* tile) {
  int begin[nodes_per_block + 1];
  count_cells(block, step.slots, work.cells, begin);
  const bool stressed =
      write_records(block, step.slots, work.cells, begin, work.records) || !step.skip.rest;
  const ZKernel<T> kernel;
  const Lanes<T> d;
  constexpr int slab = tile_nodes * tile_moment_y<T>;
  constexpr int plane = tile_nodes * tile_rows<T> * tile_row_size<T>;
  for (int x = 0; x < block_cells; ++x) {
    constexpr int n = cells_per_slab;
    const bool any = begin[n * x + n] > begin[n * x];
    if (any) {
      FIRN_UNROLL_TWICE
      for (int i = 0; i < slab; i += lane_count<T>) hn::Store(hn::Zero(d), d, work.moments + i);
      const int planes =
          x == 0 ? stencil_nodes : 1;  // finish_slab() comes to these for the first time
      const ScatterAhead<T> ahead{tile + (x == 0 ? 0 : x + 3) * plane,
                                  planes * plane / chunk_lanes<T>, next, step.slots, x};
      if (HWY_LIKELY(stressed))
        accumulate_slab<true>(kernel, begin + n * x, work.records, work.moments, ahead);
      else
        accumulate_slab<false>(kernel, begin + n * x, work.records, work.moments, ahead);
    }
    finish_slab(work.moments, x, any, tile);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
