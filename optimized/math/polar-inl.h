// SPDX-License-Identifier: BSD-3-Clause
/// The rotation R of F = R S, det R = +1.

#if defined(FIRN_KERNELS_POLAR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_KERNELS_POLAR_INL_H_
#undef FIRN_KERNELS_POLAR_INL_H_
#else
#define FIRN_KERNELS_POLAR_INL_H_
#endif

#include "optimized/math/svd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::kernels {
namespace HWY_NAMESPACE {

/// R of an F whose singular values are near 1 and whose determinant is positive, by Newton's
/// iteration X ← (X + cof X / det X)/2 (Higham 1986). The error e of the singular values goes
/// to e²/2: 0.05 → 1.3e-3 → 8e-7 → 4e-13 → 0, so three iterations serve float and four double
/// for singular values in [0.95, 1.05].
template <class D, class V>
HWY_INLINE Mat3<V> polar_near_rotation(D d, const Mat3<V>& F) {
  constexpr int iterations = sizeof(hn::TFromD<D>) == 4 ? 3 : 4;
  const V half = constant(d, 0.5);
  Mat3<V> X = F;
  for (int k = 0; k < iterations; ++k) {
    Mat3<V> C;  // cofactors
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int a = (i + 1) % 3, b = (i + 2) % 3, p = (j + 1) % 3, q = (j + 2) % 3;
        C(i, j) = MulSub(X(a, p), X(b, q), X(a, q) * X(b, p));
      }
    const V det_X = MulAdd(X(0, 0), C(0, 0), MulAdd(X(0, 1), C(0, 1), X(0, 2) * C(0, 2)));
    const V w = half / det_X;
    for (int i = 0; i < 9; ++i) X.m[i] = MulAdd(half, X.m[i], w * C.m[i]);
  }
  return X;
}

/// R = U Vᵀ of any F: the smallest singular value carries the sign of det F, R is always a
/// rotation. NaN lanes answer NaN.
template <class D, class V>
HWY_INLINE Mat3<V> polar(D d, const Mat3<V>& F) {
  Mat3<V> U, V_, R;
  Vec3<V> sigma;
  svd(d, F, U, sigma, V_);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      R(i, j) = MulAdd(U(i, 2), V_(j, 2), MulAdd(U(i, 1), V_(j, 1), U(i, 0) * V_(j, 0)));
  return R;
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::kernels
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
