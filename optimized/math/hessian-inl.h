// SPDX-License-Identifier: BSD-3-Clause
/// Semi-implicit update: the second derivative of the energy, applied to a velocity gradient. All
/// that a particle needs is found once per step and takes 15 numbers; applying it takes no
/// decomposition.

#if defined(FIRN_KERNELS_HESSIAN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_KERNELS_HESSIAN_INL_H_
#undef FIRN_KERNELS_HESSIAN_INL_H_
#else
#define FIRN_KERNELS_HESSIAN_INL_H_
#endif

#include "optimized/math/stress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::kernels {
namespace HWY_NAMESPACE {

/// With the left stretch S = √(FFᵀ), F = S R, and δF = L F, the terms of
///   A = 2μ(δF − δR) + λ(cof F : δF) cof F + λ(J−1) δ(cof F)
/// become, multiplied by Fᵀ from the right,
///   δF Fᵀ = L S²;   δR Fᵀ = [ω]× S with K ω = axial(L S − (L S)ᵀ), K = tr(S) I − S
///     (δR = [ω]× R; the skew part of δF Rᵀ = L S is that of [ω]× S plus a symmetric rest);
///   cof F Fᵀ = J I and cof F : δF = J tr L;   δ(cof F) Fᵀ = J(tr(L) I − Lᵀ), since cof F = J F⁻ᵀ.
/// Together A Fᵀ = 2μ (L S − [ω]×) S + λ(J² + (J−1)J) tr(L) I − λ(J−1)J Lᵀ.
template <class V>
struct HessianFactors {
  Sym3<V> stretch;    ///< S
  Sym3<V> K_inverse;  ///< (tr(S) I − S)⁻¹, eigenvalues 1/(σ_i + σ_j)
  V shear;            ///< 2μ V_p0 [J]
  V volume;           ///< λ(J² + (J−1)J) V_p0 [J]
  V transposed;       ///< λ(J−1)J V_p0 [J]
};

/// [ω]× y = ω × y of the axial vector of M − Mᵀ goes with this order: (M32 − M23, M13 − M31, M21 −
/// M12).
template <class V>
HWY_INLINE Vec3<V> axial(const Mat3<V>& M) {
  return {{M(2, 1) - M(1, 2), M(0, 2) - M(2, 0), M(1, 0) - M(0, 1)}};
}

/// The stretch and K⁻¹ of any F = I + D from the full decomposition. σ_i + σ_j is 0 where R is not
/// differentiable (inverted with σ2 = −σ3, or rank 1): it is kept away from 0 by about the square
/// root of the roundoff with which σ is known, so that the action stays finite.
template <class D, class V>
HWY_NOINLINE void stretch_by_svd(D d, const Mat3<V>& F_minus_I, Sym3<V>& stretch,
                                 Sym3<V>& K_inverse) {
  Mat3<V> U, V_;
  Vec3<V> sigma;
  svd(d, plus_identity(d, F_minus_I), U, sigma, V_);
  const V zero = Zero(d), one = constant(d, 1);
  const V smallest = sigma[0] * constant(d, sizeof(hn::TFromD<D>) == 4 ? 3.5e-4 : 1e-8);
  const auto null = sigma[0] <= zero;
  Vec3<V> inverse;
  for (int i = 0; i < 3; ++i) {
    const V sum = sigma[(i + 1) % 3] + sigma[(i + 2) % 3];
    inverse[i] = IfThenElse(null, zero, one / CopySign(larger(Abs(sum), smallest), sum));
  }
  const auto function = [&](const Vec3<V>& f) HWY_ATTR {
    const auto entry = [&](int i, int j) HWY_ATTR {
      return MulAdd(U(i, 2) * f[2], U(j, 2),
                    MulAdd(U(i, 1) * f[1], U(j, 1), (U(i, 0) * f[0]) * U(j, 0)));
    };
    return Sym3<V>{entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)};
  };
  stretch = function(sigma);
  K_inverse = function(inverse);
}

/// The factors of F_E = I + D; `two_mu` = 2μ V_p0 and `lambda` = λ V_p0 [J], hardened.
template <class D, class V>
HWY_INLINE HessianFactors<V> hessian_factors(D d, const Mat3<V>& F_E_minus_I, V two_mu, V lambda) {
  const V one = constant(d, 1);
  const V J_minus_1 = det_minus_one(F_E_minus_I);
  const Sym3<V> E = left_strain(F_E_minus_I);
  hn::Mask<D> small;
  const Sym3<V> G = corotated_part(d, E, small);  // E − X with S = I + X
  const Sym3<V> X = {E.xx - G.xx, E.xy - G.xy, E.xz - G.xz, E.yy - G.yy, E.yz - G.yz, E.zz - G.zz};

  HessianFactors<V> f;
  f.stretch = {one + X.xx, X.xy, X.xz, one + X.yy, X.yz, one + X.zz};
  // K = (2 + tr X) I − X: far from singular where strains are small.
  const V diagonal = constant(d, 2) + ((X.xx + X.yy) + X.zz);
  const Sym3<V> K = {diagonal - X.xx, Neg(X.xy), Neg(X.xz),
                     diagonal - X.yy, Neg(X.yz), diagonal - X.zz};
  const Sym3<V> adj = adjugate(K);
  const V w = one / MulAdd(K.xx, adj.xx, MulAdd(K.xy, adj.xy, K.xz * adj.xz));
  f.K_inverse = {adj.xx * w, adj.xy * w, adj.xz * w, adj.yy * w, adj.yz * w, adj.zz * w};

  small = And(small, J_minus_1 > constant(d, -1));
  if (HWY_UNLIKELY(!AllTrue(d, small))) {
    Sym3<V> stretch, K_inverse;
    stretch_by_svd(d, F_E_minus_I, stretch, K_inverse);
    f.stretch = select(small, f.stretch, stretch);
    f.K_inverse = select(small, f.K_inverse, K_inverse);
  }
  const V J = one + J_minus_1;
  f.shear = two_mu;
  f.transposed = lambda * (J_minus_1 * J);
  f.volume = MulAdd(lambda, J * J, f.transposed);
  return f;
}

/// V_p0 A F_Eᵀ for the velocity gradient L: the force of the node is −(V_p0 A F_Eᵀ) ∇w_ip.
template <class V>
HWY_INLINE Mat3<V> hessian_action(const HessianFactors<V>& f, const Mat3<V>& L) {
  const Mat3<V> S = full(f.stretch);
  Mat3<V> M = mul(L, S);
  const Vec3<V> omega = mul(f.K_inverse, axial(M));
  M(0, 1) = M(0, 1) + omega[2], M(1, 0) = M(1, 0) - omega[2];  // M − [ω]×
  M(0, 2) = M(0, 2) - omega[1], M(2, 0) = M(2, 0) + omega[1];
  M(1, 2) = M(1, 2) + omega[0], M(2, 1) = M(2, 1) - omega[0];
  const Mat3<V> MS = mul(M, S);
  const V pressure = f.volume * ((L(0, 0) + L(1, 1)) + L(2, 2));
  Mat3<V> result;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const V rest =
          i == j ? NegMulAdd(f.transposed, L(i, i), pressure) : Neg(f.transposed * L(j, i));
      result(i, j) = MulAdd(f.shear, MS(i, j), rest);
    }
  return result;
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::kernels
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
