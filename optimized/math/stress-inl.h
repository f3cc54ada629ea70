// SPDX-License-Identifier: BSD-3-Clause
/// Fixed corotated stress, from D = F_E − I so that small strains keep their relative accuracy.

#if defined(FIRN_KERNELS_STRESS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_KERNELS_STRESS_INL_H_
#undef FIRN_KERNELS_STRESS_INL_H_
#else
#define FIRN_KERNELS_STRESS_INL_H_
#endif

#include "optimized/math/svd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::kernels {
namespace HWY_NAMESPACE {

/// ‖FFᵀ − I‖ up to which `corotated_part` is exact to roundoff: every F with singular values in
/// [0.936, 1.06], so every elastic box of snow.
inline constexpr double small_strain_limit = 0.125;

/// (F − R)Fᵀ = b − √b with b = FFᵀ = I + E and √b = I + X. With E − X = E f(E),
/// f(x) = 1 − 1/(1+√(1+x)), f a minimax polynomial on |x| ≤ 1/8 (relative error 4e-9 in float,
/// 5e-18 in double), evaluated by Horner's rule in the basis I, E, E² with Cayley–Hamilton:
/// E³ = I1 E² − I2 E + I3. No R, no eigenvalues, no cancellation: the result is E/2 + E²/8 − …
/// `small`: the lanes in which ‖E‖ is within the limit; the others hold no valid number.
template <class D, class V>
HWY_INLINE Sym3<V> corotated_part(D d, const Sym3<V>& E, hn::Mask<D>& small) {
  const Sym3<V> E2 = square(E);
  const V trace_E2 = (E2.xx + E2.yy) + E2.zz;
  small = trace_E2 < constant(d, small_strain_limit * small_strain_limit);
  const V I1 = (E.xx + E.yy) + E.zz;
  const V I2 = constant(d, 0.5) * MulSub(I1, I1, trace_E2);
  const V I3 = det(E);
  // (a, b, c) stands for a I + b E + c E².
  V a, b, c;
  const auto horner = [&](const auto& coefficient) HWY_ATTR {
    constexpr int n = sizeof(coefficient) / sizeof(coefficient[0]);
    c = constant(d, coefficient[n - 1]);
    b = constant(d, coefficient[n - 2]);
    a = constant(d, coefficient[n - 3]);
    for (int k = n - 4; k >= -1; --k) {  // k = −1: the factor E in front of f
      const V next = k >= 0 ? MulAdd(I3, c, constant(d, coefficient[k < 0 ? 0 : k])) : I3 * c;
      const V next_b = NegMulAdd(I2, c, a);
      c = MulAdd(I1, c, b);
      b = next_b;
      a = next;
    }
  };
  if constexpr (sizeof(hn::TFromD<D>) == 4) {
    static constexpr double f[] = {0.49999999804236936186,   0.12500000711797263973,
                                   -0.062497749765510819304, 0.039059254815653564574,
                                   -0.027726156907610783297, 0.020891183850379531595};
    horner(f);
  } else {
    static constexpr double f[] = {
        0.49999999999999999979,   0.12499999999999973261,    -0.062499999999998791251,
        0.039062500000478492344,  -0.027343750001153296308,  0.020507812255464130861,
        -0.016113280832561558761, 0.013092094530440217096,   -0.010910106711627434048,
        0.0092678457030059827709, -0.0080024546305894942693, 0.0072963174452457747112,
        -0.0064885082422888820422};
    horner(f);
  }
  return {MulAdd(c, E2.xx, MulAdd(b, E.xx, a)), MulAdd(c, E2.xy, b * E.xy),
          MulAdd(c, E2.xz, b * E.xz),           MulAdd(c, E2.yy, MulAdd(b, E.yy, a)),
          MulAdd(c, E2.yz, b * E.yz),           MulAdd(c, E2.zz, MulAdd(b, E.zz, a))};
}

/// The same for any F = I + D: Σ σ_i(σ_i − 1) u_i u_iᵀ from the full decomposition.
template <class D, class V>
HWY_NOINLINE void corotated_part_svd(D d, const Mat3<V>& F_minus_I, Sym3<V>& G) {
  Mat3<V> U, V_;
  Vec3<V> sigma;
  svd(d, plus_identity(d, F_minus_I), U, sigma, V_);
  Mat3<V> W;  // u_i σ_i(σ_i − 1)
  for (int j = 0; j < 3; ++j) {
    const V w = sigma[j] * (sigma[j] - constant(d, 1));
    for (int i = 0; i < 3; ++i) W(i, j) = U(i, j) * w;
  }
  const auto entry = [&](int i, int j) HWY_ATTR {
    return MulAdd(W(i, 2), U(j, 2), MulAdd(W(i, 1), U(j, 1), W(i, 0) * U(j, 0)));
  };
  G = {entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)};
}

/// Step 3. τ = P F_Eᵀ = 2μ(F_E − R_E)F_Eᵀ + λ(J_E − 1)J_E I  [Pa], Stomakhin et al. 2013, eq. 2,
/// from its ingredients: G = (F_E − R_E)F_Eᵀ and J_E − 1.
template <class D, class V>
HWY_INLINE Sym3<V> assemble_stress(D d, const Sym3<V>& G, V J_minus_1, V mu, V lambda) {
  const V two_mu = mu + mu;
  const V pressure = lambda * MulAdd(J_minus_1, J_minus_1, J_minus_1);  // (J−1)J, J = 1 + (J−1)
  (void)d;
  return {MulAdd(two_mu, G.xx, pressure), two_mu * G.xy, two_mu * G.xz,
          MulAdd(two_mu, G.yy, pressure), two_mu * G.yz, MulAdd(two_mu, G.zz, pressure)};
}

/// Step 3 for any F_E = I + D; μ, λ [Pa] already hardened. Lanes with large strains, or with
/// det F_E ≤ 0, take the full decomposition, the others never notice.
template <class D, class V>
HWY_INLINE Sym3<V> kirchhoff_stress(D d, const Mat3<V>& F_E_minus_I, V mu, V lambda) {
  const V J_minus_1 = det_minus_one(F_E_minus_I);
  hn::Mask<D> small;
  Sym3<V> G = corotated_part(d, left_strain(F_E_minus_I), small);
  small = And(small, J_minus_1 > constant(d, -1));
  if (HWY_UNLIKELY(!AllTrue(d, small))) {
    Sym3<V> general;
    corotated_part_svd(d, F_E_minus_I, general);
    G = select(small, G, general);
  }
  return assemble_stress(d, G, J_minus_1, mu, lambda);
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::kernels
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
