// SPDX-License-Identifier: BSD-3-Clause
/// Small dense algebra on vectors: every lane is one particle.
///
/// Per-target header in the manner of Highway: it is compiled once for each
/// instruction set, inside that set's namespace. Include it (like every -inl.h of
/// this folder) after hwy/foreach_target.h and hwy/highway.h. No memory traffic,
/// no mathematical library: only IEEE +, -, ×, ÷, √ and explicit fused
/// multiply-adds, so AVX2, AVX-512 and NEON give the same bits, from g++ and from
/// clang alike. SSE4 has no fused multiply-add: there MulAdd rounds twice, every
/// bound still holds, the last bits differ.

#if defined(FIRN_KERNELS_MAT3_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_KERNELS_MAT3_INL_H_
#undef FIRN_KERNELS_MAT3_INL_H_
#else
#define FIRN_KERNELS_MAT3_INL_H_
#endif

#include <hwy/highway.h>
#include <limits>

#include "optimized/math/pair-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::kernels {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using hn::MulAdd;     // a b + c
using hn::MulSub;     // a b − c
using hn::NegMulAdd;  // c − a b

/// The larger and the smaller of two numbers; y where they are equal (zeros of either sign) or one
/// is not a number. That is one instruction on x86; Arm's own would choose +0 and spread the NaN.
#if HWY_ARCH_X86
template <class V>
HWY_INLINE V larger(const V& x, const V& y) {
  return Max(x, y);
}
template <class V>
HWY_INLINE V smaller(const V& x, const V& y) {
  return Min(x, y);
}
#else
template <class V>
HWY_INLINE V larger(const V& x, const V& y) {
  return IfThenElse(x > y, x, y);
}
template <class V>
HWY_INLINE V smaller(const V& x, const V& y) {
  return IfThenElse(x < y, x, y);
}
#endif

template <class V>
struct Vec3 {
  V v[3];
  HWY_INLINE V& operator[](int i) { return v[i]; }
  HWY_INLINE const V& operator[](int i) const { return v[i]; }
};

/// A 3x3 matrix per lane, row-major: A(i,j) = m[3i+j].
template <class V>
struct Mat3 {
  V m[9];
  HWY_INLINE V& operator()(int i, int j) { return m[3 * i + j]; }
  HWY_INLINE const V& operator()(int i, int j) const { return m[3 * i + j]; }
};

/// A symmetric 3x3 matrix per lane.
template <class V>
struct Sym3 {
  V xx, xy, xz, yy, yz, zz;
};

/// eps = 2^-23 or 2^-52, the distance from 1 to the next number.
template <class D>
HWY_INLINE hn::Vec<D> epsilon(D d, double multiple) {
  using T = hn::TFromD<D>;
  return Set(d, static_cast<T>(multiple * std::numeric_limits<T>::epsilon()));
}

template <class D>
HWY_INLINE hn::Vec<D> constant(D d, double value) {
  return Set(d, static_cast<hn::TFromD<D>>(value));
}

template <class V>
HWY_INLINE V dot(const Vec3<V>& a, const Vec3<V>& b) {
  return MulAdd(a[2], b[2], MulAdd(a[1], b[1], a[0] * b[0]));
}

/// A x
template <class V>
HWY_INLINE Vec3<V> mul(const Mat3<V>& A, const Vec3<V>& x) {
  Vec3<V> y;
  for (int i = 0; i < 3; ++i) y[i] = MulAdd(A(i, 2), x[2], MulAdd(A(i, 1), x[1], A(i, 0) * x[0]));
  return y;
}

/// S x
template <class V>
HWY_INLINE Vec3<V> mul(const Sym3<V>& S, const Vec3<V>& x) {
  return {{MulAdd(S.xz, x[2], MulAdd(S.xy, x[1], S.xx * x[0])),
           MulAdd(S.yz, x[2], MulAdd(S.yy, x[1], S.xy * x[0])),
           MulAdd(S.zz, x[2], MulAdd(S.yz, x[1], S.xz * x[0]))}};
}

/// A B
template <class V>
HWY_INLINE Mat3<V> mul(const Mat3<V>& A, const Mat3<V>& B) {
  Mat3<V> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      C(i, j) = MulAdd(A(i, 2), B(2, j), MulAdd(A(i, 1), B(1, j), A(i, 0) * B(0, j)));
  return C;
}

/// A + B C
template <class V>
HWY_INLINE Mat3<V> mul_add(const Mat3<V>& A, const Mat3<V>& B, const Mat3<V>& C) {
  Mat3<V> R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      R(i, j) =
          MulAdd(B(i, 2), C(2, j), MulAdd(B(i, 1), C(1, j), MulAdd(B(i, 0), C(0, j), A(i, j))));
  return R;
}

template <class V>
HWY_INLINE Mat3<V> full(const Sym3<V>& S) {
  return {{S.xx, S.xy, S.xz, S.xy, S.yy, S.yz, S.xz, S.yz, S.zz}};
}

/// Column j of A.
template <class V>
HWY_INLINE Vec3<V> column(const Mat3<V>& A, int j) {
  return {{A(0, j), A(1, j), A(2, j)}};
}

/// AᵀA
template <class V>
HWY_INLINE Sym3<V> gram(const Mat3<V>& A) {
  const Vec3<V> a = column(A, 0), b = column(A, 1), c = column(A, 2);
  return {dot(a, a), dot(a, b), dot(a, c), dot(b, b), dot(b, c), dot(c, c)};
}

/// S² (symmetric)
template <class V>
HWY_INLINE Sym3<V> square(const Sym3<V>& S) {
  return gram(full(S));
}

/// det S
template <class V>
HWY_INLINE V det(const Sym3<V>& S) {
  const V x = MulSub(S.yy, S.zz, S.yz * S.yz);
  const V y = MulSub(S.yz, S.xz, S.xy * S.zz);
  const V z = MulSub(S.xy, S.yz, S.yy * S.xz);
  return MulAdd(S.xx, x, MulAdd(S.xy, y, S.xz * z));
}

/// The adjugate of S: S adj(S) = det(S) I.
template <class V>
HWY_INLINE Sym3<V> adjugate(const Sym3<V>& S) {
  return {MulSub(S.yy, S.zz, S.yz * S.yz), MulSub(S.xz, S.yz, S.xy * S.zz),
          MulSub(S.xy, S.yz, S.xz * S.yy), MulSub(S.xx, S.zz, S.xz * S.xz),
          MulSub(S.xy, S.xz, S.xx * S.yz), MulSub(S.xx, S.yy, S.xy * S.xy)};
}

/// Left strain FFᵀ − I = D + Dᵀ + DDᵀ of F = I + D: no cancellation where D is small.
template <class V>
HWY_INLINE Sym3<V> left_strain(const Mat3<V>& D) {
  Sym3<V> E;
  const auto entry = [&D](int i, int j) HWY_ATTR {
    return MulAdd(D(i, 0), D(j, 0),
                  MulAdd(D(i, 1), D(j, 1), MulAdd(D(i, 2), D(j, 2), D(i, j) + D(j, i))));
  };
  E.xx = entry(0, 0), E.xy = entry(0, 1), E.xz = entry(0, 2);
  E.yy = entry(1, 1), E.yz = entry(1, 2), E.zz = entry(2, 2);
  return E;
}

/// Right strain FᵀF − I = D + Dᵀ + DᵀD of F = I + D.
template <class V>
HWY_INLINE Sym3<V> right_strain(const Mat3<V>& D) {
  Sym3<V> E;
  const auto entry = [&D](int i, int j) HWY_ATTR {
    return MulAdd(D(0, i), D(0, j),
                  MulAdd(D(1, i), D(1, j), MulAdd(D(2, i), D(2, j), D(i, j) + D(j, i))));
  };
  E.xx = entry(0, 0), E.xy = entry(0, 1), E.xz = entry(0, 2);
  E.yy = entry(1, 1), E.yz = entry(1, 2), E.zz = entry(2, 2);
  return E;
}

/// det(I + D) − 1 = tr D + Σ principal 2x2 minors + det D: keeps the relative
/// accuracy of a small volume change that J − 1 would lose.
template <class V>
HWY_INLINE V det_minus_one(const Mat3<V>& D) {
  const V c0 = MulSub(D(1, 1), D(2, 2), D(1, 2) * D(2, 1));
  const V c1 = MulSub(D(1, 2), D(2, 0), D(1, 0) * D(2, 2));
  const V c2 = MulSub(D(1, 0), D(2, 1), D(1, 1) * D(2, 0));
  const V m2 = MulSub(D(0, 0), D(1, 1), D(0, 1) * D(1, 0));
  const V m1 = MulSub(D(0, 0), D(2, 2), D(0, 2) * D(2, 0));
  const V det_D = MulAdd(D(0, 0), c0, MulAdd(D(0, 1), c1, D(0, 2) * c2));
  const V trace = (D(0, 0) + D(1, 1)) + D(2, 2);
  return trace + ((c0 + m1) + (m2 + det_D));
}

/// I + D
template <class D, class V>
HWY_INLINE Mat3<V> plus_identity(D d, const Mat3<V>& A) {
  Mat3<V> F = A;
  const V one = constant(d, 1);
  F(0, 0) = F(0, 0) + one, F(1, 1) = F(1, 1) + one, F(2, 2) = F(2, 2) + one;
  return F;
}

/// The deviator S − tr(S)/3 I and the mean tr(S)/3, from differences of the diagonal: the
/// deviator's trace vanishes to roundoff of its own size, also where S is nearly isotropic.
template <class D, class V>
HWY_INLINE Sym3<V> deviator(D d, const Sym3<V>& S, V& mean) {
  const V third = constant(d, 1.0 / 3);
  mean = ((S.xx + S.yy) + S.zz) * third;
  const V xy = S.xx - S.yy, xz = S.xx - S.zz;
  const V x = (xy + xz) * third;
  return {x, S.xy, S.xz, x - xy, S.yz, x - xz};
}

/// tr(A²)/6 of a deviator A: its eigenvalues are 2√p cos(θ + 2πk/3).
template <class D, class V>
HWY_INLINE V deviator_size(D d, const Sym3<V>& A) {
  const V off = MulAdd(A.yz, A.yz, MulAdd(A.xz, A.xz, A.xy * A.xy));
  const V diagonal = MulAdd(A.zz, A.zz, MulAdd(A.yy, A.yy, A.xx * A.xx));
  return MulAdd(constant(d, 1.0 / 6), diagonal, constant(d, 1.0 / 3) * off);
}

/// mask ? yes : no, entry by entry.
template <class M, class V>
HWY_INLINE Mat3<V> select(M mask, const Mat3<V>& yes, const Mat3<V>& no) {
  Mat3<V> R;
  for (int k = 0; k < 9; ++k) R.m[k] = IfThenElse(mask, yes.m[k], no.m[k]);
  return R;
}

template <class M, class V>
HWY_INLINE Vec3<V> select(M mask, const Vec3<V>& yes, const Vec3<V>& no) {
  return {{IfThenElse(mask, yes[0], no[0]), IfThenElse(mask, yes[1], no[1]),
           IfThenElse(mask, yes[2], no[2])}};
}

template <class M, class V>
HWY_INLINE Sym3<V> select(M mask, const Sym3<V>& yes, const Sym3<V>& no) {
  return {IfThenElse(mask, yes.xx, no.xx), IfThenElse(mask, yes.xy, no.xy),
          IfThenElse(mask, yes.xz, no.xz), IfThenElse(mask, yes.yy, no.yy),
          IfThenElse(mask, yes.yz, no.yz), IfThenElse(mask, yes.zz, no.zz)};
}

/// c0 + c1 x + … + cn xⁿ by Horner's rule; the coefficients in order c0 … cn.
template <class D, class V, int n>
HWY_INLINE V polynomial(D d, V x, const double (&c)[n]) {
  V p = constant(d, c[n - 1]);
  for (int k = n - 2; k >= 0; --k) p = MulAdd(p, x, constant(d, c[k]));
  return p;
}

/// Coefficients first … first+count−1 as a polynomial of their own; power[k] = x^(2^k).
template <int first, int count, class D, class V, int n>
HWY_INLINE V balanced_part(D d, const V* power, const double (&c)[n]) {
  if constexpr (count == 1) {
    return constant(d, c[first]);
  } else {
    constexpr int level = count > 16 ? 4 : count > 8 ? 3 : count > 4 ? 2 : count > 2 ? 1 : 0;
    const V low = balanced_part<first, 1 << level>(d, power, c);
    const V high = balanced_part<first + (1 << level), count - (1 << level)>(d, power, c);
    return MulAdd(high, power[level], low);
  }
}

/// The same polynomial as a balanced tree (Estrin): a few products more, but the chain of dependent
/// operations grows with log n instead of n. At most 32 coefficients.
template <class D, class V, int n>
HWY_INLINE V balanced_polynomial(D d, V x, const double (&c)[n]) {
  V power[5];
  power[0] = x;
  for (int k = 1; k < 5; ++k) power[k] = power[k - 1] * power[k - 1];
  return balanced_part<0, n>(d, power, c);
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::kernels
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
