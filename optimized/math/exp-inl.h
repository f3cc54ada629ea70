// SPDX-License-Identifier: BSD-3-Clause
/// e^x for the hardening factor e^{ξ(1−J_P)}, the same bits wherever fused
/// multiply-add exists (libm's differ between C libraries).

#if defined(FIRN_KERNELS_EXP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_KERNELS_EXP_INL_H_
#undef FIRN_KERNELS_EXP_INL_H_
#else
#define FIRN_KERNELS_EXP_INL_H_
#endif

#include "optimized/math/mat3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::kernels {
namespace HWY_NAMESPACE {

/// e^x within 1.05 ulp. x = n ln 2 + r, |r| ≤ ln 2 / 2; e^r = 1 + r + r² q(r); 2^n in two
/// factors, so that results pass through the denormal range to 0 and overflow to +infinity
/// exactly where e^x does. NaN stays NaN.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V exp(D d, V x) {
  using T = hn::TFromD<D>;
  constexpr bool single = sizeof(T) == 4;
  const hn::RebindToUnsigned<D> du;
  using TU = hn::TFromD<decltype(du)>;
  // Beyond these the answer is infinity or 0; they keep n inside the exponents of two factors.
  // (Comparisons, not Min and Max: those differ between processors where x is NaN.)
  const V top = constant(d, single ? 90 : 711), bottom = constant(d, single ? -105 : -747);
  x = IfThenElse(x > top, top, x);
  x = IfThenElse(x < bottom, bottom, x);

  // Adding 1.5·2^(mantissa bits) rounds to an integer and leaves it in the low bits.
  const V magic = constant(d, single ? 0x1.8p23 : 0x1.8p52);
  const V t = MulAdd(x, constant(d, 1.4426950408889634074), magic);
  const V n = t - magic;
  // ln 2 in two parts, the first with enough trailing zeros that n·part is exact.
  V r = NegMulAdd(n, constant(d, single ? 0x1.62e4p-1 : 0x1.62e42fefa3800p-1), x);
  r = NegMulAdd(n, constant(d, single ? 0x1.7f7d1cf79abcap-20 : 0x1.ef35793c7673p-45), r);

  V q;  // minimax for (e^r − 1 − r)/r²; relative error of e^r: 3e-9 and 2.9e-16·2^-7
  if constexpr (single)
    q = polynomial(d, r,
                   {0.49999993449629041245, 0.16666520635319956988, 0.041668387532715011288,
                    0.0083687166655767309884, 0.0013814629497145518872});
  else
    q = polynomial(d, r,
                   {0.50000000000000106267, 0.16666666666666412658, 0.041666666666530159767,
                    0.0083333333334943949357, 0.0013888888943630022968, 0.00019841269506694922866,
                    0.00002480149309881951231, 2.7557586287338954178e-6, 2.7630248472342869192e-7,
                    2.5000085098439664904e-8});
  const V p = constant(d, 1) + MulAdd(r * r, q, r);

  constexpr int mantissa = single ? 23 : 52;
  constexpr TU twice_bias = single ? 254 : 2046;
  const auto k = (BitCast(du, t) - BitCast(du, magic)) + Set(du, twice_bias);
  const auto half = ShiftRight<1>(k);
  const V scale1 = BitCast(d, ShiftLeft<mantissa>(half));
  const V scale2 = BitCast(d, ShiftLeft<mantissa>(k - half));
  return (p * scale1) * scale2;
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::kernels
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
