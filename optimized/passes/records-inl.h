// SPDX-License-Identifier: BSD-3-Clause
/// The first half of P2G: from particles in chunks to one record per particle,
/// sorted by cell, with everything in it that the scatter needs.

#if defined(FIRN_OPTIMIZED_RECORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_RECORDS_INL_H_
#undef FIRN_OPTIMIZED_RECORDS_INL_H_
#else
#define FIRN_OPTIMIZED_RECORDS_INL_H_
#endif

#include <hwy/cache_control.h>

#include "optimized/passes/position-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// Places in a record. The stress is stored so that C consecutive values, for
/// C = 1, 2 and 4 alike, are the components (x,y,z) of its columns: x at 4,
/// z at 6, y at 9 (a fourth component is never used).
enum Record : int {
  record_momentum = 0,  // m v_x, m v_y, m v_z, m
  record_tau_x = 4,     // 00 01 02 12 22: columns x and z overlap
  record_tau_z = 6,
  record_tau_y = 9,  // 01 11 12
  record_w_y = 12,   // 4 weights
  record_d_y = 16,   // 4 derivatives
  record_t = 20,     // offset in x, outer weights and derivatives in x
  record_w_x0 = 21,
  record_w_x3 = 22,
  record_d_x0 = 23,
  record_d_x3 = 24,
  record_r = 25,  // offset in z
};

/// 16-byte block i of v goes to to(i · step) + offset.
template <class D, class V, class To>
HWY_INLINE void store_blocks(D d, const V& v, const To& to, int step, int offset) {
  constexpr int bytes = static_cast<int>(hn::MaxLanes(D()) * sizeof(hn::TFromD<D>));
  if constexpr (bytes == 16) {
    hn::StoreU(v, d, to(0) + offset);
    (void)step;
  } else {
    const hn::Half<D> half;
    const auto upper = [&](int i) HWY_ATTR { return to(bytes / 32 * step + i); };
    store_blocks(half, hn::LowerHalf(half, v), to, step, offset);
    store_blocks(half, hn::UpperHalf(half, v), upper, step, offset);
  }
}

/// Four quantities of every lane, transposed: lane l's go to to(l)[offset … offset + 3].
template <class T, class To>
HWY_INLINE void store_quads(const Vec<T>& a, const Vec<T>& b, const Vec<T>& c, const Vec<T>& e,
                            const To& to, int offset) {
  const Lanes<T> d;
  constexpr int per_block = 16 / static_cast<int>(sizeof(T));
  const auto put = [&](int lane, const auto& v, int place) HWY_ATTR {
    const auto from_lane = [&](int i) HWY_ATTR { return to(lane + i); };
    store_blocks(d, v, from_lane, per_block, offset + place);
  };
  if constexpr (sizeof(T) == 4) {
    const Lanes<double> pairs;
    const auto ab0 = hn::BitCast(pairs, hn::InterleaveLower(d, a, b));
    const auto ab1 = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b));
    const auto ce0 = hn::BitCast(pairs, hn::InterleaveLower(d, c, e));
    const auto ce1 = hn::BitCast(pairs, hn::InterleaveUpper(d, c, e));
    put(0, hn::BitCast(d, hn::InterleaveLower(pairs, ab0, ce0)), 0);
    put(1, hn::BitCast(d, hn::InterleaveUpper(pairs, ab0, ce0)), 0);
    put(2, hn::BitCast(d, hn::InterleaveLower(pairs, ab1, ce1)), 0);
    put(3, hn::BitCast(d, hn::InterleaveUpper(pairs, ab1, ce1)), 0);
  } else {
    put(0, hn::InterleaveLower(d, a, b), 0);
    put(1, hn::InterleaveUpper(d, a, b), 0);
    put(0, hn::InterleaveLower(d, c, e), 2);
    put(1, hn::InterleaveUpper(d, c, e), 2);
  }
}

/// The chunk that holds particle i of a block; i is a multiple of the vector length.
template <class T>
HWY_INLINE T* vector_of(const BlockView<T>& block, int slots, int i) {
  const auto u = static_cast<unsigned>(i);  // so that / and % are a shift and a mask
  const unsigned chunk = u % page_particles / chunk_lanes<T>;
  return block.pages[u / page_particles] + chunk * static_cast<unsigned>(slots) * chunk_lanes<T> +
         u % chunk_lanes<T>;
}

/// Asks for slots first … last−1 of the chunk that holds particle i, if there is one.
/// A chunk's lines are not read in order, so the hardware does not see them coming.
template <class T>
HWY_INLINE void prefetch_chunk(const BlockView<T>& block, int slots, int i, int first, int last) {
  if (i >= block.count) return;
  const T* q = vector_of(block, slots, i);
  for (int s = first; s < last; ++s) hwy::Prefetch(q + s * chunk_lanes<T>);
}

/// Cell numbers (4x + y)·4 + z of all particles, and where each cell's records begin. Lanes beyond
/// the last particle lie in a cell of their own behind all others.
template <class T>
HWY_INLINE void count_cells(const BlockView<T>& block, int slots, std::uint8_t* cells,
                            int begin[nodes_per_block + 1]) {
  constexpr int n = lane_count<T>;
  constexpr int chunk = chunk_lanes<T>;
  const IntLanes<T> di;
  // Several histograms: equal neighbours do not wait for each other.
  constexpr int histograms = 4;
  int count[histograms][nodes_per_block] = {};
  alignas(cache_line) Integer<T> id[n];
  for (int i = 0; i < block.count; i += n) {
    const T* q = vector_of(block, slots, i);
    const auto x = axis_position<T>(q + slot_x * chunk).cell;
    const auto y = axis_position<T>(q + (slot_x + 1) * chunk).cell;
    const auto z = axis_position<T>(q + (slot_x + 2) * chunk).cell;
    const auto xy = hn::Add(hn::ShiftLeft<cell_bits>(x), y);
    hn::Store(hn::Add(hn::ShiftLeft<cell_bits>(xy), z), di, id);
    const int m = block.count - i < n ? block.count - i : n;
    for (int l = m; l < n; ++l) cells[i + l] = nodes_per_block;
    for (int l = 0; l < m; ++l) {
      cells[i + l] = static_cast<std::uint8_t>(id[l]);
      ++count[l % histograms][id[l] & (cells_per_block - 1)];
    }
  }
  begin[0] = 0;
  for (int c = 0; c < nodes_per_block; ++c)
    begin[c + 1] = begin[c] + count[0][c] + count[1][c] + count[2][c] + count[3][c];
}

/// One record per particle, in cell order, particles of a cell in block order.
/// Returns whether any of them is under stress (NaN is).
template <class T>
HWY_INLINE bool write_records(const BlockView<T>& block, int slots, const std::uint8_t* cells,
                              const int begin[nodes_per_block + 1], T* records) {
  constexpr int n = lane_count<T>;
  constexpr int chunk = chunk_lanes<T>;
  const Lanes<T> d;
  auto stress = hn::Zero(d);
  int next[nodes_per_block + 1];
  for (int c = 0; c <= nodes_per_block; ++c) next[c] = begin[c];
  for (int i = 0; i < block.count; i += n) {
    const T* q = vector_of(block, slots, i);
    T* record[n];
    for (int l = 0; l < n; ++l) record[l] = records + next[cells[i + l]]++ * record_size;
    const auto to = [&](int l) HWY_ATTR { return record[l]; };
    const auto slot = [&](int s) HWY_ATTR { return hn::Load(d, q + s * chunk); };
    const auto x = axis_position<T>(q + slot_x * chunk);
    const auto y = axis_position<T>(q + (slot_x + 1) * chunk);
    const auto z = axis_position<T>(q + (slot_x + 2) * chunk);
    const auto wx = axis_weights<T>(x.t, x.o), wy = axis_weights<T>(y.t, y.o);
    const auto m = slot(slot_m);
    store_quads<T>(hn::Mul(m, slot(slot_v)), hn::Mul(m, slot(slot_v + 1)),
                   hn::Mul(m, slot(slot_v + 2)), m, to, record_momentum);
    const auto t00 = slot(slot_tau), t01 = slot(slot_tau + 1), t02 = slot(slot_tau + 2);
    const auto t11 = slot(slot_tau + 3), t12 = slot(slot_tau + 4), t22 = slot(slot_tau + 5);
    store_quads<T>(t00, t01, t02, t12, to, record_tau_x);
    store_quads<T>(t22, t01, t11, t12, to, record_tau_z + 2);
    stress = hn::Or(hn::Or(hn::Or(stress, t00), hn::Or(t01, t02)), hn::Or(hn::Or(t11, t12), t22));
    store_quads<T>(wy.w[0], wy.w[1], wy.w[2], wy.w[3], to, record_w_y);
    store_quads<T>(wy.d[0], wy.d[1], wy.d[2], wy.d[3], to, record_d_y);
    store_quads<T>(x.t, wx.w[0], wx.w[3], wx.d[0], to, record_t);
    store_quads<T>(wx.d[3], z.t, z.t, z.t, to, record_d_x3);
  }
  // Any bit but the sign of a zero; spare lanes hold zeros or particles that were here.
  return !hn::AllTrue(d, hn::Le(hn::Abs(stress), hn::Zero(d)));
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
