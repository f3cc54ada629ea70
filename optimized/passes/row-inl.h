// SPDX-License-Identifier: BSD-3-Clause
/// Stencil rows: the 4 nodes in z that a particle touches, times C channels.
///
/// A vector of L lanes holds C = L/4 channels of 4 nodes, channel fastest:
/// lane = C·z + c. With L = 2 (double on SSE4 and NEON) a row takes two vectors.

#if defined(FIRN_OPTIMIZED_ROW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_ROW_INL_H_
#undef FIRN_OPTIMIZED_ROW_INL_H_
#else
#define FIRN_OPTIMIZED_ROW_INL_H_
#endif

#include <hwy/highway.h>

#include "optimized/store/layout.hpp"

/// In front of a loop so short that counting its turns costs a tenth of it.
#ifndef FIRN_UNROLL_TWICE
#ifdef __clang__
#define FIRN_UNROLL_TWICE _Pragma("clang loop unroll_count(2)")
#else
#define FIRN_UNROLL_TWICE _Pragma("GCC unroll 2")
#endif
#endif

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class T>
using Lanes = hn::ScalableTag<T>;

template <class T>
inline constexpr int lane_count = static_cast<int>(hn::MaxLanes(Lanes<T>()));
/// C, the channels of a row.
template <class T>
inline constexpr int channels = lane_count<T> >= stencil_nodes ? lane_count<T> / stencil_nodes : 1;
/// Vectors per row.
template <class T>
inline constexpr int row_vectors =
    lane_count<T> >= stencil_nodes ? 1 : stencil_nodes / lane_count<T>;
/// Values in a row of 4 nodes and in a tile row of 8.
template <class T>
inline constexpr int row_size = stencil_nodes* channels<T>;
template <class T>
inline constexpr int tile_row_size = tile_row* channels<T>;

/// Rows that hold (m v, m), and a vector: its fourth component, if there is room, is unused.
template <class T>
inline constexpr int mass_rows = 4 / channels<T>;
template <class T>
inline constexpr int force_rows = channels<T> == 1 ? 3 : 4 / channels<T>;
template <class T>
inline constexpr int tile_rows = mass_rows<T> + force_rows<T>;
/// Rows that hold (v_new, u).
template <class T>
inline constexpr int gather_rows = (6 + channels<T> - 1) / channels<T>;
/// Rows that hold a component of v_new, whose gradient is wanted.
template <class T>
inline constexpr int gradient_rows = (3 + channels<T> - 1) / channels<T>;

template <class T>
struct Row {
  hn::Vec<Lanes<T>> part[row_vectors<T>];
};

template <class T>
HWY_INLINE Row<T> load_row(const T* p) {
  const Lanes<T> d;
  Row<T> r;
  for (int i = 0; i < row_vectors<T>; ++i) r.part[i] = hn::LoadU(d, p + i * lane_count<T>);
  return r;
}

template <class T>
HWY_INLINE void store_row(const Row<T>& r, T* p) {
  const Lanes<T> d;
  for (int i = 0; i < row_vectors<T>; ++i) hn::StoreU(r.part[i], d, p + i * lane_count<T>);
}

/// A vector of type T from numbers that may be narrower.
template <class T, class From>
HWY_INLINE hn::Vec<Lanes<T>> load_wide(const From* p) {
  const Lanes<T> d;
  if constexpr (sizeof(From) == sizeof(T)) {
    return hn::LoadU(d, p);
  } else {
    return hn::PromoteTo(d, hn::LoadU(hn::Rebind<From, Lanes<T>>(), p));
  }
}

/// The same number in every lane.
template <class T>
HWY_INLINE Row<T> all(const T* p) {
  const Lanes<T> d;
  Row<T> r;
  r.part[0] = hn::Set(d, *p);
  for (int i = 1; i < row_vectors<T>; ++i) r.part[i] = r.part[0];
  return r;
}

/// p[0 … C−1] at each of the 4 nodes.
template <class T>
HWY_INLINE Row<T> all_channels(const T* p) {
  const Lanes<T> d;
  if constexpr (channels<T> == 1) {
    return all(p);
  } else if constexpr (channels<T> * sizeof(T) == 16) {
    return Row<T>{{hn::LoadDup128(d, p)}};
  } else {
    static_assert(channels<T> * sizeof(T) == 8);
    double pair;
    hwy::CopyBytes<8>(p, &pair);
    return Row<T>{{hn::BitCast(d, hn::Set(Lanes<double>(), pair))}};
  }
}

/// p[z] at node z, in each of the C channels.
template <class T>
HWY_INLINE Row<T> each_node(const T* p) {
  constexpr int C = channels<T>;
  if constexpr (C == 1) {
    return load_row(p);
  } else {
    const Lanes<T> d;
    alignas(cache_line) Integer<T> node[row_size<T>];
    for (int i = 0; i < row_size<T>; ++i) node[i] = i / C;
    const auto nodes = hn::SetTableIndices(d, node);
    if constexpr (sizeof(T) == 4) {
      return Row<T>{{hn::TableLookupLanes(hn::LoadDup128(d, p), nodes)}};
    } else {
      const hn::Half<Lanes<T>> half;
      return Row<T>{{hn::TableLookupLanes(hn::ZeroExtendVector(d, hn::LoadU(half, p)), nodes)}};
    }
  }
}

/// Where a row has two channels: what was in the other one.
template <class T>
HWY_INLINE Row<T> other_channel(const Row<T>& r) {
  static_assert(channels<T> == 2);
  return Row<T>{{hn::Reverse2(Lanes<T>(), r.part[0])}};
}

/// Where a row has two channels: the first of a beside the second of b.
template <class T>
HWY_INLINE Row<T> one_per_channel(const Row<T>& a, const Row<T>& b) {
  static_assert(channels<T> == 2);
  return Row<T>{{hn::OddEven(b.part[0], a.part[0])}};
}

template <class T>
HWY_INLINE Row<T> operator*(const Row<T>& a, const Row<T>& b) {
  Row<T> r;
  for (int i = 0; i < row_vectors<T>; ++i) r.part[i] = hn::Mul(a.part[i], b.part[i]);
  return r;
}

template <class T>
HWY_INLINE Row<T> operator+(const Row<T>& a, const Row<T>& b) {
  Row<T> r;
  for (int i = 0; i < row_vectors<T>; ++i) r.part[i] = hn::Add(a.part[i], b.part[i]);
  return r;
}

template <class T>
HWY_INLINE Row<T> operator-(const Row<T>& a, const Row<T>& b) {
  Row<T> r;
  for (int i = 0; i < row_vectors<T>; ++i) r.part[i] = hn::Sub(a.part[i], b.part[i]);
  return r;
}

/// The four sums of a row that stand for its 4 nodes in x (p2g-inl.h), `stride` apart in memory.
template <class T, int stride>
struct RowSums {
  Row<T> n0, s0, s1, n3;

  HWY_INLINE RowSums() = default;
  HWY_INLINE explicit RowSums(const T* p)
      : n0(load_row(p)),
        s0(load_row(p + stride)),
        s1(load_row(p + 2 * stride)),
        n3(load_row(p + 3 * stride)) {}

  HWY_INLINE void store(T* p) const {
    store_row(n0, p), store_row(s0, p + stride);
    store_row(s1, p + 2 * stride), store_row(n3, p + 3 * stride);
  }
};

/// a b + c
template <class T>
HWY_INLINE Row<T> mul_add(const Row<T>& a, const Row<T>& b, const Row<T>& c) {
  Row<T> r;
  for (int i = 0; i < row_vectors<T>; ++i) r.part[i] = hn::MulAdd(a.part[i], b.part[i], c.part[i]);
  return r;
}

/// Four coefficients, one per node of the row, each in all C channels.
template <class T>
HWY_INLINE Row<T> per_node(double z0, double z1, double z2, double z3) {
  alignas(cache_line) T c[row_size<T>];
  const double z[4] = {z0, z1, z2, z3};
  for (int i = 0; i < row_size<T>; ++i) c[i] = static_cast<T>(z[i / channels<T>]);
  return load_row(c);
}

/// Weights and derivatives of the 4 nodes in z of a particle at r in [0,1) above the
/// second of them. With s = 1−r, r, 1−r, r the distance that matters at each node:
///   outer nodes  N = s³/6            N' = ∓s²/2
///   inner nodes  N = 2/3 − s² + s³/2  N' = ∓(2s − 3s²/2), with s and 1−s exchanged
/// The inner ones are at distance r and 1−r, the outer ones at 1+r and 2−r: written
/// in s the outer branch is the factored (2−|x|)³/6, which keeps its relative
/// accuracy down to weight zero.
template <class T>
struct ZKernel {
  Row<T> base, sign, w3, w2, w0, d3, d2;

  HWY_INLINE ZKernel()
      : base(per_node<T>(1, 0, 1, 0)),
        sign(per_node<T>(-1, 1, -1, 1)),
        w3(per_node<T>(1.0 / 6, 0.5, 0.5, 1.0 / 6)),
        w2(per_node<T>(0, -1, -1, 0)),
        w0(per_node<T>(0, 2.0 / 3, 2.0 / 3, 0)),
        d3(per_node<T>(-0.5, 1.5, -1.5, 0.5)),
        d2(per_node<T>(0, -2, 2, 0)) {}

  HWY_INLINE void weights(const T* r, Row<T>& w, Row<T>& d) const { weights(all(r), w, d); }
  HWY_INLINE void weights(const Row<T>& r, Row<T>& w, Row<T>& d) const {
    const Row<T> s = mul_add(sign, r, base);
    const Row<T> s2 = s * s;
    w = mul_add(mul_add(w3, s, w2), s2, w0);
    d = mul_add(d3, s, d2) * s;
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
