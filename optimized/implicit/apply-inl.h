// SPDX-License-Identifier: BSD-3-Clause
/// The operator of the semi-implicit update on one block of particles: the gradient of
/// a node field (gradient-inl.h), multiplied by the second derivative of the energy, and
/// scattered (force-inl.h).
///
/// Particles lie in cell order, so a slab of cells is gathered, acted upon and scattered
/// while its weights and records are in the first-level cache.

#if defined(FIRN_OPTIMIZED_IMPLICIT_APPLY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_IMPLICIT_APPLY_INL_H_
#undef FIRN_OPTIMIZED_IMPLICIT_APPLY_INL_H_
#else
#define FIRN_OPTIMIZED_IMPLICIT_APPLY_INL_H_
#endif

#include <type_traits>

#include "optimized/implicit/force-inl.h"
#include "optimized/implicit/layout.hpp"
#include "optimized/math/hessian-inl.h"
#include "optimized/passes/fold-inl.h"
#include "optimized/passes/records-inl.h"
#include "optimized/passes/surroundings-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

namespace kn = firn::kernels::HWY_NAMESPACE;

/// A vector of floats has as many lanes as two of doubles, which may lie in different chunks.
template <class T, class S>
inline constexpr bool over_two_chunks = lane_count<T> > chunk_lanes<S>;

/// Rounds two vectors of doubles to one of floats.
HWY_INLINE Vec<float> demote(const Vec<double>& low, const Vec<double>& high) {
  const Lanes<float> d;
  const hn::Half<Lanes<float>> half;
  return hn::Combine(d, hn::DemoteTo(half, high), hn::DemoteTo(half, low));
}

/// Values of type S as lanes of type T. A value of the next chunk lies `chunk_size` further on.
template <class T, class S>
HWY_INLINE Vec<T> load_as(const S* p, int chunk_size) {
  if constexpr (sizeof(T) >= sizeof(S)) {
    return load_wide<T>(p);
  } else {
    const Lanes<S> d;
    const S* const next = p + (over_two_chunks<T, S> ? chunk_size : lane_count<S>);
    return demote(hn::Load(d, p), hn::Load(d, next));
  }
}

/// axis_position() of positions stored in type S.
template <class T, class S>
HWY_INLINE AxisPosition<T> axis_position_as(const S* slot, int chunk_size) {
  if constexpr (std::is_same_v<T, S>) {
    return axis_position<T>(slot);
  } else if constexpr (sizeof(T) < sizeof(S)) {
    const Lanes<S> d;
    const S* const next = slot + (over_two_chunks<T, S> ? chunk_size : lane_count<S>);
    const auto x = hn::Load(d, slot), y = hn::Load(d, next);
    const auto low = hn::Floor(x), high = hn::Floor(y);
    const auto t = hn::Sub(x, low), u = hn::Sub(y, high);
    const auto one = hn::Set(d, 1.0);
    return {hn::ConvertTo(IntLanes<T>(), demote(low, high)), demote(t, u),
            demote(hn::Sub(one, t), hn::Sub(one, u))};
  } else {
    const Lanes<T> d;
    const IntLanes<T> di;
    const hn::Rebind<S, Lanes<T>> narrow;
    const hn::Rebind<std::int32_t, Lanes<T>> integers;
    const auto x = hn::BitCast(integers, hn::LoadU(narrow, slot));
    const auto fraction = hn::And(x, hn::Set(integers, fixed_one - 1));
    const auto unit = hn::Set(d, 1.0 / fixed_one);
    AxisPosition<T> a;
    a.cell = hn::PromoteTo(di, hn::ShiftRight<fixed_bits>(x));
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

/// Asks for what act() reads of the particles from number i on, if there are any: single
/// lines of the store, which the hardware does not see coming.
template <class S>
HWY_INLINE void prefetch_particles(const HessianBlock<S>& block, int i) {
  if (i >= block.particles.count) return;
  const S* const q = vector_of(block.particles, block.slots, i);
  for (const int slot : {slot_x + 0, slot_x + 1, slot_x + 2, slot_stiffness + 0})
    hwy::Prefetch(q + slot * chunk_lanes<S>);
}

/// Weights and records, V_p0 A F_Eᵀ, of a vector of particles from number i on. The slab's first
/// place is that of particle `first`.
template <class T, class S>
HWY_INLINE void act(const HessianBlock<S>& block, int i, int first, const HessianScratch<T>& work) {
  constexpr int L = lane_count<T>, C = channels<T>, chunk = chunk_lanes<S>;
  constexpr int stride = L * row_size<T>;
  const Lanes<T> d;
  const IntLanes<T> di;
  const S* const q = vector_of(block.particles, block.slots, i);
  const S* const f = factors_of(block.factors, i);
  const int count = block.particles.count;
  const int n = count - i < L ? count - i : L;
  constexpr int ahead = 2 * (L > chunk ? L : chunk);
  if (i % chunk == 0)
    for (int k = 0; k < L; k += chunk) prefetch_particles(block, i + ahead + k);
  T* const records = work.records + (i - first) * hessian_record_size;
  const auto to = [&](int l) HWY_ATTR { return records + l * hessian_record_size; };

  const int chunk_size = block.slots * chunk;
  const auto x = axis_position_as<T>(q + slot_x * chunk, chunk_size);
  const auto y = axis_position_as<T>(q + (slot_x + 1) * chunk, chunk_size);
  const auto z = axis_position_as<T>(q + (slot_x + 2) * chunk, chunk_size);
  const auto wx = axis_weights<T>(x.t, x.o), wy = axis_weights<T>(y.t, y.o);
  const auto wz = axis_weights<T>(z.t, z.o);
  T* const weights = weights_of(work, i - first);
  const auto put = [&](int which, const Vec<T>& value)
                       HWY_ATTR { hn::Store(value, d, weights + which * L); };
  for (int j = 0; j < stencil_nodes; ++j)
    put(weight_y + j, wy.w[j]), put(derivative_y + j, wy.d[j]);
  put(weight_t, x.t), put(weight_x0, wx.w[0]), put(weight_x3, wx.w[3]);
  put(derivative_x0, wx.d[0]), put(derivative_x3, wx.d[3]);
  store_quads<T>(wz.w[0], wz.w[1], wz.w[2], wz.w[3], to, hessian_record_w_z);
  store_quads<T>(wz.d[0], wz.d[1], wz.d[2], wz.d[3], to, hessian_record_d_z);
  alignas(cache_line) Integer<T> place[L];  // 4 (7x + y) + z; 7x = 8x − x
  static_assert(tile_nodes == 7);
  const auto xy = hn::Add(hn::Sub(hn::ShiftLeft<3>(x.cell), x.cell), y.cell);
  hn::Store(hn::Add(hn::ShiftLeft<cell_bits>(xy), z.cell), di, place);

  alignas(cache_line) T rows[3 * vector_rows<T> * stride];
  for (int l = 0; l < n;) {
    const int at = static_cast<int>(place[l]);
    const T* from =
        work.coefficients + (at >> cell_bits) * gradient_y<T> + (at & (block_cells - 1)) * C;
    T* out = rows + l * row_size<T>;
    if (in_pairs<T> && l + 1 < n && place[l + 1] == place[l]) {
      gather_pair(weights + l, to(l), from, out, stride);
      l += 2;
    } else {
      gather_particle(weights + l, to(l), from, out, stride);
      l += 1;
    }
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

  const auto slot = [&](int s)
                        HWY_ATTR { return load_as<T>(f + s * chunk, hessian_slots * chunk); };
  const auto symmetric = [&](int s) HWY_ATTR {
    return kn::Sym3<Vec<T>>{slot(s),     slot(s + 1), slot(s + 2),
                            slot(s + 3), slot(s + 4), slot(s + 5)};
  };
  const kn::HessianFactors<Vec<T>> factors = {symmetric(hessian_stretch), symmetric(hessian_K),
                                              load_as<T>(q + slot_stiffness * chunk, chunk_size),
                                              slot(hessian_volume), slot(hessian_transposed)};
  const auto A = kn::hessian_action(factors, gradient);
  const auto zero = hn::Zero(d);
  store_quads<T>(A(0, 0), A(1, 0), A(2, 0), zero, to, hessian_record_x);
  store_quads<T>(A(0, 1), A(1, 1), A(2, 1), zero, to, hessian_record_y);
  store_quads<T>(A(0, 2), A(1, 2), A(2, 2), zero, to, hessian_record_z);
}

template <class T>
HWY_INLINE void copy_vectors(int count, const T* from, T* to) {
  const Lanes<T> d;
  for (int k = 0; k < count * lane_count<T>; k += lane_count<T>)
    hn::Store(hn::Load(d, from + k), d, to + k);
}

template <class T, class S>
void apply_hessian(const HessianBlock<S>& block, const HessianScratch<T>& work, T* tile) {
  const Lanes<T> d;
  constexpr int slab = tile_nodes * moment_y<T>, L = lane_count<T>;
  int first = 0, done = 0;  // particles first … done − 1 have their places, whole vectors of them
  for (int x = 0; x < block_cells; ++x) {
    const std::int32_t* begin = block.begin + cells_per_slab * x;
    // The slab before is over; its last vector may have held some of this one.
    const int start = begin[0] / L * L;
    if (start < done && start > first) {
      copy_vectors(hessian_weights, weights_of(work, start - first), work.weights);
      copy_vectors(hessian_record_size, work.records + (start - first) * hessian_record_size,
                   work.records);
    }
    first = start;
    for (; done < begin[cells_per_slab]; done += L) act<T>(block, done, first, work);
    const bool any = begin[cells_per_slab] > begin[0];
    if (any) {
      for (int i = 0; i < slab; i += lane_count<T>) hn::Store(hn::Zero(d), d, work.moments + i);
      for (int c = 0; c < cells_per_slab; ++c)
        scatter_cell(work, begin[c] - first, begin[c + 1] - begin[c],
                     work.moments + c / block_cells * moment_y<T> + c % block_cells * channels<T>);
    }
    finish_planes(work.moments, x, any, tile);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
