// SPDX-License-Identifier: BSD-3-Clause
/// The last contraction of the gather, over z: L particles' rows in, one vector of
/// L particles per channel out, out[c][l] = Σ_z row_l[z][c].

#if defined(FIRN_OPTIMIZED_FOLD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_FOLD_INL_H_
#undef FIRN_OPTIMIZED_FOLD_INL_H_
#else
#define FIRN_OPTIMIZED_FOLD_INL_H_
#endif

#include "optimized/passes/position-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// Even lanes of a beside even lanes of b, pairwise: (a0 b0 a2 b2 …).
template <class D, class V>
HWY_INLINE V evens(D d, const V& a, const V& b) {
  if constexpr (sizeof(hn::TFromD<D>) == 8) {
    return hn::InterleaveLower(d, a, b);
  } else {
    return hn::OddEven(hn::Shuffle2301(b), a);
  }
}

template <class D, class V>
HWY_INLINE V odds(D d, const V& a, const V& b) {
  if constexpr (sizeof(hn::TFromD<D>) == 8) {
    return hn::InterleaveUpper(d, a, b);
  } else {
    return hn::OddEven(b, hn::Shuffle2301(a));
  }
}

/// Halves of a and b folded: [a.lower + a.upper | b.lower + b.upper].
template <class D, class V>
HWY_INLINE V fold_halves(D d, const V& a, const V& b) {
  return hn::Add(hn::ConcatLowerLower(d, b, a), hn::ConcatUpperUpper(d, b, a));
}

/// The same inside each pair of 16-byte blocks.
template <class D, class V>
HWY_INLINE V fold_blocks(D, const V& a, const V& b) {
  return hn::Add(hn::OddEvenBlocks(hn::SwapAdjacentBlocks(b), a),
                 hn::OddEvenBlocks(b, hn::SwapAdjacentBlocks(a)));
}

/// The same inside each 16-byte block, 8-byte halves.
template <class D, class V>
HWY_INLINE V fold_pairs(D d, const V& a, const V& b) {
  const Lanes<double> pairs;
  const auto x = hn::BitCast(pairs, a), y = hn::BitCast(pairs, b);
  return hn::Add(hn::BitCast(d, hn::InterleaveLower(pairs, x, y)),
                 hn::BitCast(d, hn::InterleaveUpper(pairs, x, y)));
}

/// `rows`: L rows of 4·C values, one per particle, `stride` apart.
template <class T>
HWY_INLINE void fold(const T* rows, int stride, Vec<T>* out) {
  const Lanes<T> d;
  constexpr int L = lane_count<T>;
  const auto row = [&](int l) HWY_ATTR { return hn::Load(d, rows + l * stride); };
  if constexpr (L == 2) {  // z0 z1 | z2 z3 of two particles
    const auto a = hn::Add(row(0), hn::Load(d, rows + 2));
    const auto b = hn::Add(row(1), hn::Load(d, rows + stride + 2));
    out[0] = hn::Add(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
  } else if constexpr (sizeof(T) == 4 && L == 4) {
    const auto a = fold_pairs(d, row(0), row(2)), b = fold_pairs(d, row(1), row(3));
    out[0] = hn::Add(evens(d, a, b), odds(d, a, b));
  } else if constexpr (sizeof(T) == 8 && L == 4) {
    const auto a = fold_halves(d, row(0), row(2)), b = fold_halves(d, row(1), row(3));
    out[0] = hn::Add(evens(d, a, b), odds(d, a, b));
  } else if constexpr (sizeof(T) == 4 && L == 8) {
    const auto a = fold_pairs(d, fold_halves(d, row(0), row(4)), fold_halves(d, row(2), row(6)));
    const auto b = fold_pairs(d, fold_halves(d, row(1), row(5)), fold_halves(d, row(3), row(7)));
    out[0] = evens(d, a, b);
    out[1] = odds(d, a, b);
  } else if constexpr (sizeof(T) == 8 && L == 8) {
    const auto a = fold_blocks(d, fold_halves(d, row(0), row(4)), fold_halves(d, row(2), row(6)));
    const auto b = fold_blocks(d, fold_halves(d, row(1), row(5)), fold_halves(d, row(3), row(7)));
    out[0] = evens(d, a, b);
    out[1] = odds(d, a, b);
  } else {
    static_assert(sizeof(T) == 4 && L == 16);
    Vec<T> q[4];  // 16-byte block b of q[k]: the four channels of particle 4b + k
    for (int k = 0; k < 4; ++k)
      q[k] = fold_blocks(d, fold_halves(d, row(k), row(k + 8)),
                         fold_halves(d, row(k + 4), row(k + 12)));
    const Lanes<double> pairs;
    const auto low0 = hn::BitCast(pairs, hn::InterleaveLower(d, q[0], q[1]));
    const auto up0 = hn::BitCast(pairs, hn::InterleaveUpper(d, q[0], q[1]));
    const auto low1 = hn::BitCast(pairs, hn::InterleaveLower(d, q[2], q[3]));
    const auto up1 = hn::BitCast(pairs, hn::InterleaveUpper(d, q[2], q[3]));
    out[0] = hn::BitCast(d, hn::InterleaveLower(pairs, low0, low1));
    out[1] = hn::BitCast(d, hn::InterleaveUpper(pairs, low0, low1));
    out[2] = hn::BitCast(d, hn::InterleaveLower(pairs, up0, up1));
    out[3] = hn::BitCast(d, hn::InterleaveUpper(pairs, up0, up1));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
