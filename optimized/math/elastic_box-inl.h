// SPDX-License-Identifier: BSD-3-Clause
/// "Are all singular values of F_E inside [1−θ_c, 1+θ_s]?" without computing them.

#if defined(FIRN_KERNELS_ELASTIC_BOX_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_KERNELS_ELASTIC_BOX_INL_H_
#undef FIRN_KERNELS_ELASTIC_BOX_INL_H_
#else
#define FIRN_KERNELS_ELASTIC_BOX_INL_H_
#endif

#include "optimized/math/elastic_box.hpp"
#include "optimized/math/mat3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::kernels {
namespace HWY_NAMESPACE {

/// Is S positive definite? The pivots of LDLᵀ, cleared of denominators (S_xx times the
/// Schur complement): no division, and as backward stable as Cholesky: a "yes" holds for
/// a matrix within a few eps·S_ii of S. NaN answers no.
template <class D, class V>
HWY_INLINE hn::Mask<D> positive_definite(D d, const Sym3<V>& S) {
  const V zero = Zero(d);
  const V yy = MulSub(S.xx, S.yy, S.xy * S.xy);
  const V yz = MulSub(S.xx, S.yz, S.xy * S.xz);
  const V zz = MulSub(S.xx, S.zz, S.xz * S.xz);
  const V last = MulSub(yy, zz, yz * yz);
  return And(And(S.xx > zero, yy > zero), last > zero);
}

/// Lanes whose singular values certainly lie inside the box, from the (left or right) strain
/// E = FFᵀ − I and J − 1 of F: E + (1−lo²) I ≻ 0, (hi²−1) I − E ≻ 0 and J > 0, each with a
/// margin. Never claimed beyond 4 eps of a limit; a "no" close to a limit may be wrong, then
/// the return mapping finds nothing to clamp.
template <class D, class V>
HWY_INLINE hn::Mask<D> inside_elastic_box(D d, const Sym3<V>& E, V J_minus_1,
                                          const ElasticBox<hn::TFromD<D>>& box) {
  const V below = Set(d, box.below), above = Set(d, box.above);
  const Sym3<V> low = {E.xx + below, E.xy, E.xz, E.yy + below, E.yz, E.zz + below};
  // The off-diagonals of above·I − E are −E_ij: their signs cancel in every pivot.
  const Sym3<V> high = {above - E.xx, E.xy, E.xz, above - E.yy, Neg(E.yz), above - E.zz};
  return And(And(positive_definite(d, low), positive_definite(d, high)),
             J_minus_1 > constant(d, -1));
}

/// The same from D = F − I.
template <class D, class V>
HWY_INLINE hn::Mask<D> inside_elastic_box(D d, const Mat3<V>& F_minus_I,
                                          const ElasticBox<hn::TFromD<D>>& box) {
  return inside_elastic_box(d, left_strain(F_minus_I), det_minus_one(F_minus_I), box);
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::kernels
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
