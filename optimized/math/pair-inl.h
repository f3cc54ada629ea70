// SPDX-License-Identifier: BSD-3-Clause
/// Two vectors as one. The kernels of this folder are written for a Highway tag D and
/// its vectors; with PairOf<D> the same bodies work on twice as many particles, the
/// operations of the two halves side by side in the instruction stream: where one
/// half waits for a root or a division, the other fills the gap. Each lane's result
/// is, bit for bit, that of D alone.

#if defined(FIRN_KERNELS_PAIR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_KERNELS_PAIR_INL_H_
#undef FIRN_KERNELS_PAIR_INL_H_
#else
#define FIRN_KERNELS_PAIR_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace firn::kernels {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Tag of two vectors of D; hn::Vec, hn::Mask, hn::TFromD and hn::RebindToUnsigned understand it.
template <class D>
struct PairOf {
  using T = typename D::T;
  template <class U>
  using Rebind = PairOf<hn::Rebind<U, D>>;
};

template <class V>
struct Pair {
  V a, b;
};

template <class M>
struct MaskPair {
  M a, b;
};

template <class D>
HWY_INLINE Pair<hn::Vec<D>> Zero(PairOf<D>) {
  return {hn::Zero(D()), hn::Zero(D())};
}
template <class D, class T>
HWY_INLINE Pair<hn::Vec<D>> Set(PairOf<D>, T value) {
  return {hn::Set(D(), value), hn::Set(D(), value)};
}
/// Both halves from consecutive memory.
template <class D, class T>
HWY_INLINE Pair<hn::Vec<D>> LoadU(PairOf<D>, const T* p) {
  return {hn::LoadU(D(), p), hn::LoadU(D(), p + hn::Lanes(D()))};
}
template <class D, class V, class T>
HWY_INLINE void StoreU(const Pair<V>& v, PairOf<D>, T* p) {
  hn::StoreU(v.a, D(), p), hn::StoreU(v.b, D(), p + hn::Lanes(D()));
}
template <class D>
HWY_INLINE std::size_t Lanes(PairOf<D>) {
  return 2 * hn::Lanes(D());
}
template <class V>
HWY_INLINE auto MaskFromVec(const Pair<V>& v) -> MaskPair<decltype(hn::MaskFromVec(v.a))> {
  return {hn::MaskFromVec(v.a), hn::MaskFromVec(v.b)};
}
template <class D, class V>
HWY_INLINE auto BitCast(PairOf<D>, const Pair<V>& v) -> Pair<hn::Vec<D>> {
  return {hn::BitCast(D(), v.a), hn::BitCast(D(), v.b)};
}
template <int n, class V>
HWY_INLINE Pair<V> ShiftLeft(const Pair<V>& v) {
  return {hn::ShiftLeft<n>(v.a), hn::ShiftLeft<n>(v.b)};
}
template <int n, class V>
HWY_INLINE Pair<V> ShiftRight(const Pair<V>& v) {
  return {hn::ShiftRight<n>(v.a), hn::ShiftRight<n>(v.b)};
}

// Everything else goes through both halves in the same way.
#define FIRN_PAIR_1(op)                     \
  template <class V>                        \
  HWY_INLINE Pair<V> op(const Pair<V>& x) { \
    return {hn::op(x.a), hn::op(x.b)};      \
  }
#define FIRN_PAIR_2(op)                                       \
  template <class V>                                          \
  HWY_INLINE Pair<V> op(const Pair<V>& x, const Pair<V>& y) { \
    return {hn::op(x.a, y.a), hn::op(x.b, y.b)};              \
  }
#define FIRN_PAIR_3(op)                                                         \
  template <class V>                                                            \
  HWY_INLINE Pair<V> op(const Pair<V>& x, const Pair<V>& y, const Pair<V>& z) { \
    return {hn::op(x.a, y.a, z.a), hn::op(x.b, y.b, z.b)};                      \
  }
#define FIRN_PAIR_COMPARE(name, op)                                                                \
  template <class V>                                                                               \
  HWY_INLINE auto name(const Pair<V>& x, const Pair<V>& y)->MaskPair<decltype(hn::op(x.a, y.a))> { \
    return {hn::op(x.a, y.a), hn::op(x.b, y.b)};                                                   \
  }
#define FIRN_PAIR_MASK(op)                                                \
  template <class M>                                                      \
  HWY_INLINE MaskPair<M> op(const MaskPair<M>& x, const MaskPair<M>& y) { \
    return {hn::op(x.a, y.a), hn::op(x.b, y.b)};                          \
  }
FIRN_PAIR_1(Neg)
FIRN_PAIR_1(Abs)
FIRN_PAIR_1(Sqrt)
FIRN_PAIR_2(Min)
FIRN_PAIR_2(Max)
FIRN_PAIR_2(And)
FIRN_PAIR_2(CopySign)
FIRN_PAIR_3(MulAdd)
FIRN_PAIR_3(MulSub)
FIRN_PAIR_3(NegMulAdd)
FIRN_PAIR_COMPARE(operator<, Lt)
FIRN_PAIR_COMPARE(operator>, Gt)
FIRN_PAIR_COMPARE(operator<=, Le)
FIRN_PAIR_COMPARE(Lt, Lt)
FIRN_PAIR_COMPARE(Gt, Gt)
FIRN_PAIR_COMPARE(Ne, Ne)
FIRN_PAIR_MASK(And)
FIRN_PAIR_MASK(Or)
FIRN_PAIR_MASK(AndNot)
#undef FIRN_PAIR_1
#undef FIRN_PAIR_2
#undef FIRN_PAIR_3
#undef FIRN_PAIR_COMPARE
#undef FIRN_PAIR_MASK

template <class V>
HWY_INLINE Pair<V> operator+(const Pair<V>& x, const Pair<V>& y) {
  return {x.a + y.a, x.b + y.b};
}
template <class V>
HWY_INLINE Pair<V> operator-(const Pair<V>& x, const Pair<V>& y) {
  return {x.a - y.a, x.b - y.b};
}
template <class V>
HWY_INLINE Pair<V> operator*(const Pair<V>& x, const Pair<V>& y) {
  return {x.a * y.a, x.b * y.b};
}
template <class V>
HWY_INLINE Pair<V> operator/(const Pair<V>& x, const Pair<V>& y) {
  return {x.a / y.a, x.b / y.b};
}
template <class V>
HWY_INLINE auto IsFinite(const Pair<V>& x) -> MaskPair<decltype(hn::IsFinite(x.a))> {
  return {hn::IsFinite(x.a), hn::IsFinite(x.b)};
}
template <class M>
HWY_INLINE MaskPair<M> Not(const MaskPair<M>& x) {
  return {hn::Not(x.a), hn::Not(x.b)};
}
template <class M, class V>
HWY_INLINE Pair<V> IfThenElse(const MaskPair<M>& m, const Pair<V>& yes, const Pair<V>& no) {
  return {hn::IfThenElse(m.a, yes.a, no.a), hn::IfThenElse(m.b, yes.b, no.b)};
}
template <class M, class V>
HWY_INLINE Pair<V> IfThenElseZero(const MaskPair<M>& m, const Pair<V>& yes) {
  return {hn::IfThenElseZero(m.a, yes.a), hn::IfThenElseZero(m.b, yes.b)};
}
template <class D, class M>
HWY_INLINE bool AllTrue(PairOf<D>, const MaskPair<M>& m) {
  return hn::AllTrue(D(), hn::And(m.a, m.b));
}
template <class D, class M>
HWY_INLINE bool AllFalse(PairOf<D>, const MaskPair<M>& m) {
  return hn::AllFalse(D(), hn::Or(m.a, m.b));
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::kernels
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
