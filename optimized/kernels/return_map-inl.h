/// Step 7: clamp the singular values of F̂_E to [1−θ_c, 1+θ_s] and move the rest into F_P.

#if defined(FIRN_KERNELS_RETURN_MAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_KERNELS_RETURN_MAP_INL_H_
#undef FIRN_KERNELS_RETURN_MAP_INL_H_
#else
#define FIRN_KERNELS_RETURN_MAP_INL_H_
#endif

#include "optimized/kernels/elastic_box-inl.h"
#include "optimized/kernels/svd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::kernels {
namespace HWY_NAMESPACE {

/// F̂ − I = D + Δt L + Δt L D of F̂ = (I + Δt L)(I + D); M = Δt L.
template <class V>
HWY_INLINE Mat3<V> trial_deformation(const Mat3<V>& F_minus_I, const Mat3<V>& dt_L) {
  Mat3<V> R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const V t = MulAdd(
          dt_L(i, 2), F_minus_I(2, j),
          MulAdd(dt_L(i, 1), F_minus_I(1, j), MulAdd(dt_L(i, 0), F_minus_I(0, j), dt_L(i, j))));
      R(i, j) = F_minus_I(i, j) + t;
    }
  return R;
}

/// What a clamp does to one singular value σ = 1 + s: c = clamp(σ).
template <class V>
struct Clamped {
  V gamma;       ///< c/σ − 1
  V eta;         ///< σ/c − 1
  V difference;  ///< c − σ; exactly 0 inside the box
};

template <class D, class V>
HWY_INLINE Clamped<V> clamp_stretch(D d, V sigma_minus_1, const ElasticBox<hn::TFromD<D>>& box) {
  const V lo = hn::Set(d, box.lo_minus_1), hi = hn::Set(d, box.hi_minus_1);
  Clamped<V> r;
  r.difference = hn::Min(hn::Max(sigma_minus_1, lo), hi) - sigma_minus_1;
  r.gamma = r.difference / (constant(d, 1) + sigma_minus_1);
  // Where something is clamped, c is one of two known numbers: no second division.
  const V minus_inverse_c = hn::IfThenElse(sigma_minus_1 > hi, hn::Set(d, box.minus_inverse_hi),
                                           hn::Set(d, box.minus_inverse_lo));
  r.eta = r.difference * minus_inverse_c;
  return r;
}

/// √(1+ε) − 1 for ε in [−3/4, 3], to an error of about eps ε: the root's rounding error is found
/// from the residual ε − t(t+2) and taken off.
template <class D, class V>
HWY_INLINE V sqrt_one_plus_minus_one(D d, V e) {
  const V one = constant(d, 1);
  const V t = hn::Sqrt(one + e) - one;
  const V residual = NegMulAdd(t, t + constant(d, 2), e);
  // Newton's 1/(2(1+t)) to first order: the correction itself is of the size of one rounding.
  return MulAdd(constant(d, 0.5) * residual, one - t, t);
}

/// tr(A²)/6 of strains that cannot be told from isotropic ones.
template <class T>
inline constexpr double isotropic = sizeof(T) == 4 ? 1e-20 : 1e-40;

/// Γ and H with F_E = F̂(I + Γ), F_P = (I + H) F_P^old: functions of C = F̂ᵀF̂ = I + E, with the
/// eigenvalues c/σ − 1 and σ/c − 1, from C's isolated root, that root's projector and the closed
/// 2x2 remainder: no eigenvectors, no full decomposition.
/// `changed`: lanes in which some σ is clamped. `safe`: lanes in the range [½, 2] of σ with J > 0,
/// where squaring F̂ costs a few eps at most; the others hold no valid numbers.
template <class D, class V>
HWY_INLINE void clamp_functions(D d, const Sym3<V>& E, V J_minus_1,
                                const ElasticBox<hn::TFromD<D>>& box, Sym3<V>& Gamma, Sym3<V>& H,
                                hn::Mask<D>& changed, hn::Mask<D>& safe) {
  const V one = constant(d, 1), half = constant(d, 0.5), three_halves = constant(d, 1.5);
  V mean;
  const Sym3<V> A = deviator(d, E, mean);
  // A deviator far below roundoff of 1 counts as 0; the floor keeps the cubes below normal.
  const V p = hn::Max(deviator_size(d, A), constant(d, isotropic<hn::TFromD<D>>));
  const V size = hn::Sqrt(p);
  const V inverse = one / size;
  // The isolated root of A: 2√p cos(θ), with the sign of the determinant 2 p^{3/2} h.
  const V det_A = det(A);
  const V h = hn::Abs(det_A) * ((inverse * inverse) * (inverse * half));
  const V c = svd_detail::cos_third(d, hn::Min(h, one));
  const V half_root = hn::CopySign(size * c, det_A), root = half_root + half_root;

  // Its projector adj(A − root)/trace, the trace being (root−λ2)(root−λ3) = 3p(4c² − 1) ≥ 6p: known
  // before the adjugate is.
  const V w = one / ((p * constant(d, 3)) * MulSub(constant(d, 4), c * c, one));
  const Sym3<V> adj = adjugate(Sym3<V>{A.xx - root, A.xy, A.xz, A.yy - root, A.yz, A.zz - root});
  const Sym3<V> P = {adj.xx * w, adj.xy * w, adj.xz * w, adj.yy * w, adj.yz * w, adj.zz * w};
  // The trace-free remainder N in the plane, eigenvalues ±delta.
  const V k = root * three_halves;
  const Sym3<V> N = {NegMulAdd(k, P.xx, A.xx + half_root),
                     NegMulAdd(k, P.xy, A.xy),
                     NegMulAdd(k, P.xz, A.xz),
                     NegMulAdd(k, P.yy, A.yy + half_root),
                     NegMulAdd(k, P.yz, A.yz),
                     NegMulAdd(k, P.zz, A.zz + half_root)};
  const V N_size = constant(d, 3) * deviator_size(d, N);  // deviator_size is tr(N²)/6
  const V delta = hn::Sqrt(hn::Max(N_size, constant(d, isotropic<hn::TFromD<D>>)));

  const V e1 = mean + root, plane = mean - half_root;
  const V e2 = plane + delta, e3 = plane - delta;
  const V largest = hn::Max(hn::Max(e1, e2), e3), smallest = hn::Min(hn::Min(e1, e2), e3);
  safe = hn::And(hn::And(largest<constant(d, 3), smallest> constant(d, -0.75)),
                 J_minus_1 > constant(d, -1));

  const Clamped<V> r1 = clamp_stretch(d, sqrt_one_plus_minus_one(d, e1), box);
  const Clamped<V> r2 = clamp_stretch(d, sqrt_one_plus_minus_one(d, e2), box);
  const Clamped<V> r3 = clamp_stretch(d, sqrt_one_plus_minus_one(d, e3), box);
  const V zero = hn::Zero(d);
  changed = hn::Or(hn::Or(r1.difference != zero, r2.difference != zero), r3.difference != zero);

  // f(C) = f1 P + (f2+f3)/2 (I − P) + (f2−f3)/(2 delta) N
  const V half_by_delta = half / delta;
  const auto function = [&](V f1, V f2, V f3) HWY_ATTR {
    const V a = (f2 + f3) * half, b = (f2 - f3) * half_by_delta, q = f1 - a;
    return Sym3<V>{MulAdd(q, P.xx, MulAdd(b, N.xx, a)), MulAdd(q, P.xy, b * N.xy),
                   MulAdd(q, P.xz, b * N.xz),           MulAdd(q, P.yy, MulAdd(b, N.yy, a)),
                   MulAdd(q, P.yz, b * N.yz),           MulAdd(q, P.zz, MulAdd(b, N.zz, a))};
  };
  Gamma = function(r1.gamma, r2.gamma, r3.gamma);
  H = function(r1.eta, r2.eta, r3.eta);
}

/// The increments of F_E and F_P from the full decomposition F̂ = U Σ̂ Vᵀ, c = clamp(Σ̂):
/// ΔF_E = U (c − Σ̂) Vᵀ and H = V (Σ̂/c − 1) Vᵀ. Any F̂, also singular or inverted.
template <class D, class V>
HWY_NOINLINE void clamp_by_svd(D d, const Mat3<V>& F_hat_minus_I,
                               const ElasticBox<hn::TFromD<D>>& box, Mat3<V>& delta_F_E, Sym3<V>& H,
                               hn::Mask<D>& changed) {
  const V one = constant(d, 1), zero = hn::Zero(d);
  Mat3<V> U, V_, W, Z;
  Vec3<V> sigma;
  svd(d, plus_identity(d, F_hat_minus_I), U, sigma, V_);
  changed = hn::MaskFromVec(zero);
  for (int j = 0; j < 3; ++j) {
    // Comparisons rather than Min and Max: NaN must pass through on every processor.
    const V s = sigma[j] - one, lo = hn::Set(d, box.lo_minus_1), hi = hn::Set(d, box.hi_minus_1);
    const V c = hn::IfThenElse(s > hi, hi, hn::IfThenElse(s < lo, lo, s));
    const V difference = c - s;
    changed = hn::Or(changed, difference != zero);
    const V eta = hn::Neg(difference / (one + c));
    for (int i = 0; i < 3; ++i) W(i, j) = U(i, j) * difference, Z(i, j) = V_(i, j) * eta;
  }
  const auto times_Vt = [&](const Mat3<V>& X, int i, int j) HWY_ATTR {
    return MulAdd(X(i, 2), V_(j, 2), MulAdd(X(i, 1), V_(j, 1), X(i, 0) * V_(j, 0)));
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) delta_F_E(i, j) = times_Vt(W, i, j);
  H = {times_Vt(Z, 0, 0), times_Vt(Z, 0, 1), times_Vt(Z, 0, 2),
       times_Vt(Z, 1, 1), times_Vt(Z, 1, 2), times_Vt(Z, 2, 2)};
}

/// Which way the return mapping takes: `fast` for production, `svd` to measure and test it.
enum class ReturnMap { fast, svd };

/// Step 7 after the trial state: in: F̂_E − I and F_P − I; out: F_E − I and F_P − I with
/// F_E F_P = F̂_E F_P^old and every σ(F_E) in the box. Returns the lanes in which something was
/// clamped; all other lanes keep every bit. J_P = det F_P: det_minus_one() of the new F_P − I.
template <ReturnMap path = ReturnMap::fast, class D, class V>
HWY_INLINE hn::Mask<D> return_map(D d, const ElasticBox<hn::TFromD<D>>& box, Mat3<V>& F_E_minus_I,
                                  Mat3<V>& F_P_minus_I) {
  const V J_minus_1 = det_minus_one(F_E_minus_I);
  Mat3<V> delta_F_E;
  Sym3<V> H;
  hn::Mask<D> changed;
  if constexpr (path == ReturnMap::fast) {
    Sym3<V> Gamma;
    hn::Mask<D> safe;
    clamp_functions(d, right_strain(F_E_minus_I), J_minus_1, box, Gamma, H, changed, safe);
    const Mat3<V> G = full(Gamma);
    delta_F_E = mul_add(G, F_E_minus_I, G);  // F̂ Γ = Γ + (F̂ − I) Γ
    if (HWY_UNLIKELY(!hn::AllTrue(d, safe))) {
      Mat3<V> delta_svd;
      Sym3<V> H_svd;
      hn::Mask<D> changed_svd;
      clamp_by_svd(d, F_E_minus_I, box, delta_svd, H_svd, changed_svd);
      delta_F_E = select(safe, delta_F_E, delta_svd);
      H = select(safe, H, H_svd);
      changed = hn::Or(hn::And(safe, changed), hn::AndNot(safe, changed_svd));
    }
  } else {
    clamp_by_svd(d, F_E_minus_I, box, delta_F_E, H, changed);
  }
  const Mat3<V> H_full = full(H);
  const Mat3<V> delta_F_P = mul_add(H_full, H_full, F_P_minus_I);
  for (int k = 0; k < 9; ++k) {
    F_E_minus_I.m[k] = hn::IfThenElse(changed, F_E_minus_I.m[k] + delta_F_E.m[k], F_E_minus_I.m[k]);
    F_P_minus_I.m[k] = hn::IfThenElse(changed, F_P_minus_I.m[k] + delta_F_P.m[k], F_P_minus_I.m[k]);
  }
  return changed;
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::kernels
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
