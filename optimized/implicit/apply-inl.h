/// The operator of the semi-implicit update on one block of particles: the gradient of
/// a node field is gathered as in stage 7, multiplied by the second derivative of the
/// energy, and scattered as the force of stage 3. The forms of the sums in x are those
/// of g2p-inl.h and p2g-inl.h, for 3 channels instead of 6 and 7.
///
/// Particles lie in cell order, so a slab of cells is gathered, acted upon and scattered
/// while its records are in the first-level cache.

#if defined(FIRN_OPTIMIZED_IMPLICIT_APPLY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_IMPLICIT_APPLY_INL_H_
#undef FIRN_OPTIMIZED_IMPLICIT_APPLY_INL_H_
#else
#define FIRN_OPTIMIZED_IMPLICIT_APPLY_INL_H_
#endif

#include <type_traits>

#include "optimized/fold-inl.h"
#include "optimized/implicit/layout.hpp"
#include "optimized/kernels/hessian-inl.h"
#include "optimized/records-inl.h"
#include "optimized/surroundings-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

namespace kn = firn::kernels::HWY_NAMESPACE;

/// Rows of a vector field: 3 channels.
template <class T>
inline constexpr int vector_rows = force_rows<T>;
/// Values per stencil row of a tile, and per plane.
template <class T>
inline constexpr int vector_row = vector_rows<T>* tile_row_size<T>;
template <class T>
inline constexpr int vector_plane = tile_nodes* vector_row<T>;

/// Places in an operator's record. τ' = V_p0 A F_Eᵀ is not symmetric: three whole columns.
enum HessianRecord : int {
  hessian_record_x = 0,  // τ'00 τ'10 τ'20 –
  hessian_record_y = 4,
  hessian_record_z = 8,
};

/// Values of type S as lanes of type T.
template <class T, class S>
HWY_INLINE Vec<T> load_as(const S* p) {
  const Lanes<T> d;
  if constexpr (std::is_same_v<T, S>) {
    return hn::Load(d, p);
  } else {
    const hn::Rebind<S, Lanes<T>> narrow;
    return hn::PromoteTo(d, hn::LoadU(narrow, p));
  }
}

/// axis_position() of positions stored in type S.
template <class T, class S>
HWY_INLINE AxisPosition<T> axis_position_as(const S* slot) {
  if constexpr (std::is_same_v<T, S>) {
    return axis_position<T>(slot);
  } else {
    const Lanes<T> d;
    const IntLanes<T> di;
    const hn::Rebind<S, Lanes<T>> narrow;
    const hn::Rebind<std::int32_t, Lanes<T>> integers;
    const auto x = hn::BitCast(integers, hn::LoadU(narrow, slot));
    const auto fraction = hn::And(x, hn::Set(integers, fixed_one - 1));
    const auto unit = hn::Set(d, 1.0 / fixed_one);
    AxisPosition<T> a;
    a.cell = hn::PromoteTo(di, hn::ShiftRight<28>(x));
    a.t = hn::Mul(hn::PromoteTo(d, fraction), unit);
    a.o = hn::Sub(hn::Set(d, 1.0), a.t);
    return a;
  }
}

/// The factors of particles from number i on.
template <class S>
HWY_INLINE S* factors_of(S* factors, int i) {
  constexpr int chunk = chunk_lanes<S>;
  return factors + i / chunk * (hessian_slots * chunk) + i % chunk;
}

/// V, Δ and S of the local values: [x 1…5][y][V, Δ, S][row][z][channel].
template <class T>
void vector_difference(const HessianScratch<T>& work) {
  const Lanes<T> d;
  for (int x = 1; x <= 5; ++x)
    for (int y = 0; y < tile_nodes; ++y) {
      const T* from = work.local + x * vector_plane<T> + y * vector_row<T>;
      T* to = work.coefficients + ((x - 1) * tile_nodes + y) * 3 * vector_row<T>;
      for (int i = 0; i < vector_row<T>; i += lane_count<T>) {
        const auto v = hn::Load(d, from + i);
        const auto right = hn::Sub(hn::Load(d, from + vector_plane<T> + i), v);
        const auto left = hn::Sub(v, hn::Load(d, from - vector_plane<T> + i));
        hn::Store(v, d, to + i);
        hn::Store(right, d, to + vector_row<T> + i);
        hn::Store(hn::Sub(right, left), d, to + 2 * vector_row<T> + i);
      }
    }
}

/// h ∇u at one particle: 3·vector_rows rows to `out`, `stride` apart; weights from its record.
template <class T>
HWY_INLINE void gather_gradient(const ZKernel<T>& kernel, const T* record, const T* from, T* out,
                                int stride) {
  constexpr int R = tile_row_size<T>, rows = vector_rows<T>, y_stride = 3 * vector_row<T>;
  const Row<T> t = all(record + record_t), w0 = all(record + record_w_x0),
               w3 = all(record + record_w_x3), d0 = all(record + record_d_x0),
               d3 = all(record + record_d_x3);
  Row<T> value[rows], d_x[rows], d_y[rows];
  for (int j = 0; j < 4; ++j, from += y_stride) {
    const Row<T> w_y = all(record + record_w_y + j), dw_y = all(record + record_d_y + j);
    for (int r = 0; r < rows; ++r) {
      const T* p = from + r * R;
      const Row<T> slope = load_row(p + vector_row<T>);
      const Row<T> s1 = load_row(p + 2 * vector_row<T>);
      const Row<T> s2 = load_row(p + tile_nodes * y_stride + 2 * vector_row<T>);
      const Row<T> b = mul_add(w3, s2, mul_add(w0, s1, mul_add(t, slope, load_row(p))));
      const Row<T> e = mul_add(d3, s2, mul_add(d0, s1, slope));
      value[r] = j == 0 ? w_y * b : mul_add(w_y, b, value[r]);
      d_y[r] = j == 0 ? dw_y * b : mul_add(dw_y, b, d_y[r]);
      d_x[r] = j == 0 ? w_y * e : mul_add(w_y, e, d_x[r]);
    }
  }
  Row<T> w, d;
  kernel.weights(record + record_r, w, d);
  for (int r = 0; r < rows; ++r) {
    store_row(d_x[r] * w, out + 3 * r * stride);
    store_row(d_y[r] * w, out + (3 * r + 1) * stride);
    store_row(value[r] * d, out + (3 * r + 2) * stride);
  }
}

/// Asks for what act() reads of the particles from number i on, if there are any: single
/// lines of the store, which the hardware does not see coming.
template <class S>
HWY_INLINE void prefetch_particles(const HessianBlock<S>& block, int i) {
  if (i >= block.particles.count) return;
  const S* const q = vector_of(block.particles, block.slots, i);
  for (const int slot : {slot_x + 0, slot_x + 1, slot_x + 2, slot_stiffness + 0})
    hwy::Prefetch(q + slot * chunk_lanes<S>);
}

/// Records of a vector of particles from number i on: weights and V_p0 A F_Eᵀ. The first
/// record is that of particle `first`.
template <class T, class S>
HWY_INLINE void act(const ZKernel<T>& kernel, const HessianBlock<S>& block, int i, int first,
                    const HessianScratch<T>& work) {
  constexpr int L = lane_count<T>, C = channels<T>, chunk = chunk_lanes<S>;
  constexpr int stride = L * row_size<T>;
  const Lanes<T> d;
  const IntLanes<T> di;
  const S* const q = vector_of(block.particles, block.slots, i);
  const S* const f = factors_of(block.factors, i);
  const int count = block.particles.count;
  const int n = count - i < L ? count - i : L;
  if (i % chunk == 0) prefetch_particles(block, i + 2 * chunk);
  T* to[L];
  for (int l = 0; l < L; ++l) to[l] = work.records + (i - first + l) * record_size;

  const auto x = axis_position_as<T>(q + slot_x * chunk);
  const auto y = axis_position_as<T>(q + (slot_x + 1) * chunk);
  const auto z = axis_position_as<T>(q + (slot_x + 2) * chunk);
  const auto wx = axis_weights<T>(x.t, x.o), wy = axis_weights<T>(y.t, y.o);
  store_quads<T>(wy.w[0], wy.w[1], wy.w[2], wy.w[3], to, record_w_y);
  store_quads<T>(wy.d[0], wy.d[1], wy.d[2], wy.d[3], to, record_d_y);
  store_quads<T>(x.t, wx.w[0], wx.w[3], wx.d[0], to, record_t);
  store_quads<T>(wx.d[3], z.t, z.t, z.t, to, record_d_x3);
  alignas(64) Integer<T> place[L];  // 4 (7x + y) + z; 7x = 8x − x
  const auto xy = hn::Add(hn::Sub(hn::ShiftLeft<3>(x.cell), x.cell), y.cell);
  hn::Store(hn::Add(hn::ShiftLeft<2>(xy), z.cell), di, place);

  alignas(64) T rows[3 * vector_rows<T> * stride];
  for (int l = 0; l < n; ++l) {
    const int at = static_cast<int>(place[l]);
    gather_gradient(kernel, to[l], work.coefficients + (at >> 2) * (3 * vector_row<T>)+(at & 3) * C,
                    rows + l * row_size<T>, stride);
  }
  if (HWY_UNLIKELY(n < L)) {
    for (int r = 0; r < 3 * vector_rows<T>; ++r)
      for (int k = n * row_size<T>; k < stride; ++k) rows[r * stride + k] = 0;
  }
  kn::Mat3<Vec<T>> gradient;
  for (int r = 0; r < vector_rows<T>; ++r)
    for (int axis = 0; axis < 3; ++axis) {
      Vec<T> out[C];
      fold<T>(rows + (3 * r + axis) * stride, row_size<T>, out);
      for (int c = 0; c < C && r * C + c < 3; ++c) gradient.m[3 * (r * C + c) + axis] = out[c];
    }

  const auto slot = [&](int s) HWY_ATTR { return load_as<T>(f + s * chunk); };
  const auto symmetric = [&](int s) HWY_ATTR {
    return kn::Sym3<Vec<T>>{slot(s),     slot(s + 1), slot(s + 2),
                            slot(s + 3), slot(s + 4), slot(s + 5)};
  };
  const kn::HessianFactors<Vec<T>> factors = {symmetric(hessian_stretch), symmetric(hessian_K),
                                              load_as<T>(q + slot_stiffness * chunk),
                                              slot(hessian_volume), slot(hessian_transposed)};
  const auto A = kn::hessian_action(factors, gradient);
  const auto zero = hn::Zero(d);
  store_quads<T>(A(0, 0), A(1, 0), A(2, 0), zero, to, hessian_record_x);
  store_quads<T>(A(0, 1), A(1, 1), A(2, 1), zero, to, hessian_record_y);
  store_quads<T>(A(0, 2), A(1, 2), A(2, 2), zero, to, hessian_record_z);
}

/// The z-rows of one particle's τ'.
template <class T>
struct HessianRows {
  Row<T> x[vector_rows<T>], y[vector_rows<T>], z[vector_rows<T>];
};

/// `count` rows from `first` on of the particles of one cell, at y-node j; see p2g-inl.h.
template <int first, int count, class T>
HWY_INLINE void accumulate_rows(const HessianRows<T>* rows, const T* record, int n, int j,
                                T* sums) {
  constexpr int R = tile_row_size<T>;
  Row<T> n0[count], s0[count], s1[count], n3[count];
  for (int r = 0; r < count; ++r) {
    n0[r] = load_row(sums + r * R), s0[r] = load_row(sums + vector_row<T> + r * R);
    s1[r] = load_row(sums + 2 * vector_row<T> + r * R);
    n3[r] = load_row(sums + 3 * vector_row<T> + r * R);
  }
  for (int p = 0; p < n; ++p, record += record_size) {
    const Row<T> w_y = all(record + record_w_y + j), d_y = all(record + record_d_y + j);
    Row<T> b[count], D[count];
    for (int r = 0; r < count; ++r) {
      b[r] = w_y * rows[p].z[first + r];
      D[r] = w_y * rows[p].x[first + r];
    }
    for (int r = 0; r < count; ++r) b[r] = mul_add(d_y, rows[p].y[first + r], b[r]);
    for (int r = 0; r < count; ++r) s0[r] = s0[r] + b[r];
    const Row<T> t = all(record + record_t);
    for (int r = 0; r < count; ++r) s1[r] = mul_add(t, b[r], s1[r]) + D[r];
    const Row<T> w0 = all(record + record_w_x0);
    for (int r = 0; r < count; ++r) n0[r] = mul_add(w0, b[r], n0[r]);
    const Row<T> d0 = all(record + record_d_x0);
    for (int r = 0; r < count; ++r) n0[r] = mul_add(d0, D[r], n0[r]);
    const Row<T> w3 = all(record + record_w_x3);
    for (int r = 0; r < count; ++r) n3[r] = mul_add(w3, b[r], n3[r]);
    const Row<T> d3 = all(record + record_d_x3);
    for (int r = 0; r < count; ++r) n3[r] = mul_add(d3, D[r], n3[r]);
  }
  for (int r = 0; r < count; ++r) {
    store_row(n0[r], sums + r * R), store_row(s0[r], sums + vector_row<T> + r * R);
    store_row(s1[r], sums + 2 * vector_row<T> + r * R);
    store_row(n3[r], sums + 3 * vector_row<T> + r * R);
  }
}

/// The particles of one cell onto the slab's sums [y][n0, s0, s1, n3][row][z][channel].
template <class T>
HWY_INLINE void scatter_cell(const ZKernel<T>& kernel, const T* record, int count, T* moments) {
  constexpr int C = channels<T>, batch = 16;  // 16 particles' rows fit beside the sums in L1
  constexpr int y_stride = 4 * vector_row<T>;
  HWY_ALIGN HessianRows<T> rows[batch];
  for (int p = 0; p < count; p += batch, record += batch * record_size) {
    const int n = count - p < batch ? count - p : batch;
    for (int k = 0; k < n; ++k) {
      const T* q = record + k * record_size;
      Row<T> w, dw;
      kernel.weights(q + record_r, w, dw);
      for (int r = 0; r < vector_rows<T>; ++r) {
        rows[k].x[r] = w * all_channels(q + hessian_record_x + r * C);
        rows[k].y[r] = w * all_channels(q + hessian_record_y + r * C);
        rows[k].z[r] = dw * all_channels(q + hessian_record_z + r * C);
      }
    }
    for (int j = 0; j < 4; ++j) {
      T* sums = moments + j * y_stride;
      if constexpr (vector_rows<T> == 3) {
        accumulate_rows<0, 2>(rows, record, n, j, sums);
        accumulate_rows<2, 1>(rows, record, n, j, sums + 2 * tile_row_size<T>);
      } else {
        accumulate_rows<0, vector_rows<T>>(rows, record, n, j, sums);
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
    const T* m = moments + y * 4 * vector_row<T>;
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

template <class T, class S>
void apply_hessian(const HessianBlock<S>& block, const HessianScratch<T>& work, T* tile) {
  const ZKernel<T> kernel;
  const Lanes<T> d;
  constexpr int slab = tile_nodes * 4 * vector_row<T>;
  int first = 0, done = 0;  // there are records of particles first … done − 1
  for (int x = 0; x < block_cells; ++x) {
    const std::int32_t* begin = block.begin + 16 * x;
    // The slab before is over; its last vector may have held some of this one.
    const T* from = work.records + (begin[0] - first) * record_size;
    for (int i = 0; i < (done - begin[0]) * record_size; ++i) work.records[i] = from[i];
    first = begin[0];
    for (; done < begin[16]; done += lane_count<T>) act<T>(kernel, block, done, first, work);
    const bool any = begin[16] > begin[0];
    if (any) {
      for (int i = 0; i < slab; i += lane_count<T>) hn::Store(hn::Zero(d), d, work.moments + i);
      for (int c = 0; c < 16; ++c)
        scatter_cell(kernel, work.records + (begin[c] - first) * record_size,
                     begin[c + 1] - begin[c],
                     work.moments + c / 4 * 4 * vector_row<T> + c % 4 * channels<T>);
    }
    finish_planes(work.moments, x, any, tile);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
