// SPDX-License-Identifier: BSD-3-Clause
/// Reading and writing the slots of a vector of particles, or of two side by side, and finding the
/// first particle whose numbers are not finite.

#if defined(FIRN_OPTIMIZED_SLOTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_SLOTS_INL_H_
#undef FIRN_OPTIMIZED_SLOTS_INL_H_
#else
#define FIRN_OPTIMIZED_SLOTS_INL_H_
#endif

#include "optimized/passes/constitutive-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// Nine consecutive slots of the particles at q.
template <class T>
HWY_INLINE kn::Mat3<Vec<T>> load_matrix(const T* q, int slot) {
  kn::Mat3<Vec<T>> A;
  for (int i = 0; i < 9; ++i) A.m[i] = hn::Load(Lanes<T>(), q + (slot + i) * chunk_lanes<T>);
  return A;
}

/// Where a vector of particles lies, and where the two of a pair lie.
template <class T>
struct OneVector {
  using Tag = Lanes<T>;
  T* q;
};
template <class T>
struct TwoVectors {
  using Tag = kn::PairOf<Lanes<T>>;
  T *a, *b;
};

template <class T>
HWY_INLINE Vec<T> load_slot(const OneVector<T>& at, int slot) {
  return hn::Load(Lanes<T>(), at.q + slot * chunk_lanes<T>);
}
template <class T>
HWY_INLINE kn::Pair<Vec<T>> load_slot(const TwoVectors<T>& at, int slot) {
  return {hn::Load(Lanes<T>(), at.a + slot * chunk_lanes<T>),
          hn::Load(Lanes<T>(), at.b + slot * chunk_lanes<T>)};
}

template <class T>
HWY_INLINE void store_slot(const Vec<T>& v, const OneVector<T>& at, int slot) {
  hn::Store(v, Lanes<T>(), at.q + slot * chunk_lanes<T>);
}
template <class T>
HWY_INLINE void store_slot(const kn::Pair<Vec<T>>& v, const TwoVectors<T>& at, int slot) {
  hn::Store(v.a, Lanes<T>(), at.a + slot * chunk_lanes<T>);
  hn::Store(v.b, Lanes<T>(), at.b + slot * chunk_lanes<T>);
}

template <class Place>
HWY_INLINE auto load_matrix(const Place& at, int slot) -> kn::Mat3<decltype(load_slot(at, slot))> {
  kn::Mat3<decltype(load_slot(at, slot))> A;
  for (int i = 0; i < 9; ++i) A.m[i] = load_slot(at, slot + i);
  return A;
}

template <class Place, class V>
HWY_INLINE void store_matrix(const kn::Mat3<V>& A, const Place& at, int slot) {
  for (int i = 0; i < 9; ++i) store_slot(A.m[i], at, slot + i);
}

/// Lanes 0 … n−1 in which every one of the values is finite.
template <class T>
HWY_INLINE hn::Mask<Lanes<T>> finite(const Vec<T>* value, int count) {
  const Lanes<T> d;
  auto sum = hn::Zero(d);  // 0·x is 0 or NaN
  for (int i = 0; i < count; ++i) sum = hn::MulAdd(value[i], hn::Zero(d), sum);
  return hn::Eq(sum, hn::Zero(d));
}

/// Notes the first lane below n that is not in `good`, if no fault is known yet.
template <class T>
HWY_INLINE void expect(const hn::Mask<Lanes<T>>& good, int i, int n, Fault fault,
                       FaultReport& report) {
  const Lanes<T> d;
  const auto bad = hn::And(hn::Not(good), hn::FirstN(d, static_cast<std::size_t>(n)));
  if (HWY_LIKELY(hn::AllFalse(d, bad)) || report.fault != Fault::none) return;
  report.fault = fault;
  report.place = i + static_cast<int>(hn::FindFirstTrue(d, bad));
}

template <class Place>
HWY_INLINE auto load_deformation(const Place& at) -> Deformation<decltype(load_slot(at, 0))> {
  Deformation<decltype(load_slot(at, 0))> p;
  const typename Place::Tag d;
  p.E_E = load_matrix(at, slot_E_E);
  p.E_P = load_matrix(at, slot_E_P);
  p.stiffness = load_slot(at, slot_stiffness);
  p.tau = {Zero(d), Zero(d), Zero(d), Zero(d), Zero(d), Zero(d)};
  return p;
}

template <class Place, class V>
HWY_INLINE void store_tau(const kn::Sym3<V>& tau, const Place& at) {
  const V values[6] = {tau.xx, tau.xy, tau.xz, tau.yy, tau.yz, tau.zz};
  for (int k = 0; k < 6; ++k) store_slot(values[k], at, slot_tau + k);
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
