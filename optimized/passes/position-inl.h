// SPDX-License-Identifier: BSD-3-Clause
/// Positions inside a block and the kernel weights that follow from them, one
/// particle in every lane.
///
/// double: x in units of h, 0 ≤ x < 4. float: the same as a fixed-point integer
/// (layout.hpp), because a float cannot say where between two cells a particle
/// sits to better than 2e-7 h, and both t and 1−t enter the outer weights cubed.

#if defined(FIRN_OPTIMIZED_POSITION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_POSITION_INL_H_
#undef FIRN_OPTIMIZED_POSITION_INL_H_
#else
#define FIRN_OPTIMIZED_POSITION_INL_H_
#endif

#include "optimized/passes/row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

template <class T>
using Vec = hn::Vec<Lanes<T>>;
template <class T>
using IntLanes = hn::RebindToSigned<Lanes<T>>;
template <class T>
using IntVec = hn::Vec<IntLanes<T>>;

/// log2 of block_cells and of fixed_one: shifts that divide by them.
inline constexpr int cell_bits = 2, fixed_bits = 28;
static_assert(1 << cell_bits == block_cells && 1 << fixed_bits == fixed_one);

/// Along one axis: the cell 0 … 3, the offset t in it and o = 1 − t.
template <class T>
struct AxisPosition {
  IntVec<T> cell;
  Vec<T> t, o;
};

template <class T>
HWY_INLINE AxisPosition<T> axis_position(const T* slot) {
  const Lanes<T> d;
  const IntLanes<T> di;
  AxisPosition<T> a;
  if constexpr (sizeof(T) == 4) {
    const auto x = hn::BitCast(di, hn::Load(d, slot));
    a.cell = hn::ShiftRight<fixed_bits>(x);
    const auto fraction = hn::And(x, hn::Set(di, fixed_one - 1));
    const auto unit = hn::Set(d, 1.0f / static_cast<float>(fixed_one));
    a.t = hn::Mul(hn::ConvertTo(d, fraction), unit);
    a.o = hn::Mul(hn::ConvertTo(d, hn::Sub(hn::Set(di, fixed_one), fraction)), unit);
  } else {
    const auto x = hn::Load(d, slot);
    const auto floor = hn::Floor(x);
    // Without a 64-bit conversion, which AVX2 lacks: 2^52 + n holds n in its last bits.
    const auto shifted = hn::BitCast(di, hn::Add(floor, hn::Set(d, 0x1p52)));
    a.cell = hn::And(shifted, hn::Set(di, block_cells - 1));
    a.t = hn::Sub(x, floor);
    a.o = hn::Sub(hn::Set(d, 1.0), a.t);
  }
  return a;
}

/// N and N' at the four nodes around a particle (Stomakhin et al. 2013, section 4),
/// outer branch factored: w0 = o³/6, w3 = t³/6.
template <class T>
struct AxisWeights {
  Vec<T> w[stencil_nodes], d[stencil_nodes];
};

template <class T>
HWY_INLINE AxisWeights<T> axis_weights(const Vec<T>& t, const Vec<T>& o) {
  const Lanes<T> d;
  const auto c = [&](double value) HWY_ATTR { return hn::Set(d, static_cast<T>(value)); };
  const auto t2 = hn::Mul(t, t), o2 = hn::Mul(o, o);
  AxisWeights<T> a;
  a.w[0] = hn::Mul(hn::Mul(o2, o), c(1.0 / 6));
  a.w[1] = hn::MulAdd(hn::MulAdd(c(0.5), t, c(-1)), t2, c(2.0 / 3));
  a.w[2] = hn::MulAdd(hn::MulAdd(c(0.5), o, c(-1)), o2, c(2.0 / 3));
  a.w[3] = hn::Mul(hn::Mul(t2, t), c(1.0 / 6));
  a.d[0] = hn::Mul(o2, c(-0.5));
  a.d[1] = hn::Mul(hn::MulAdd(c(1.5), t, c(-2)), t);
  a.d[2] = hn::Mul(hn::NegMulAdd(c(1.5), o, c(2)), o);
  a.d[3] = hn::Mul(t2, c(0.5));
  return a;
}

/// Stage 10 along one axis: x + Δx [h]. |Δx| < 4 is the caller's promise for the
/// lanes whose result it uses.
template <class T>
HWY_INLINE Vec<T> moved(const T* slot, const Vec<T>& displacement) {
  const Lanes<T> d;
  if constexpr (sizeof(T) == 4) {
    const IntLanes<T> di;
    const auto x = hn::BitCast(di, hn::Load(d, slot));
    const auto scaled = hn::Mul(displacement, hn::Set(d, static_cast<float>(fixed_one)));
    return hn::BitCast(d, hn::Add(x, hn::NearestInt(scaled)));
  } else {
    return hn::Add(hn::Load(d, slot), displacement);
  }
}

/// 0 ≤ x < limit, in the lanes' own representation.
template <class T>
HWY_INLINE hn::Mask<Lanes<T>> inside(const Vec<T>& x, T limit) {
  const Lanes<T> d;
  if constexpr (sizeof(T) == 4) {
    const IntLanes<T> di;
    const auto xi = hn::BitCast(di, x);
    const auto top = hn::Set(di, static_cast<std::int32_t>(limit * static_cast<float>(fixed_one)));
    return hn::RebindMask(d, hn::And(hn::Gt(xi, hn::Set(di, -1)), hn::Lt(xi, top)));
  } else {
    return hn::And(hn::Ge(x, hn::Zero(d)), hn::Lt(x, hn::Set(d, limit)));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
