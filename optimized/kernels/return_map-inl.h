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
  const V one = constant(d, 1);
  const V c =
      hn::Min(hn::Max(sigma_minus_1, hn::Set(d, box.lo_minus_1)), hn::Set(d, box.hi_minus_1));
  Clamped<V> r;
  r.difference = c - sigma_minus_1;
  const V sigma = one + sigma_minus_1, clamped = one + c;
  const V w = r.difference / (sigma * clamped);
  r.gamma = w * clamped;
  r.eta = hn::Neg(w * sigma);
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

/// Γ and H with F_E = F̂(I + Γ), F_P = (I + H) F_P^old: functions of C = F̂ᵀF̂ = I + E, with the
/// eigenvalues c/σ − 1 and σ/c − 1, from C's isolated root, that root's projector and the closed
/// 2x2 remainder: no eigenvectors, no full decomposition.
/// `changed`: lanes in which some σ is clamped. `safe`: lanes in the range [½, 2] of σ with J > 0,
/// where squaring F̂ costs a few eps at most; the others hold no valid numbers.
template <class D, class V>
HWY_INLINE void clamp_functions(D d, const Sym3<V>& E, V J_minus_1,
                                const ElasticBox<hn::TFromD<D>>& box, Sym3<V>& Gamma, Sym3<V>& H,
                                hn::Mask<D>& changed, hn::Mask<D>& safe) {
  const V one = constant(d, 1), half = constant(d, 0.5);
  const V mean = ((E.xx + E.yy) + E.zz) * constant(d, 1.0 / 3);
  // The deviator from differences of the diagonal: its trace vanishes to roundoff of its own size,
  // which E − mean I does not give where E is nearly isotropic.
  const V xy = E.xx - E.yy, xz = E.xx - E.zz;
  const V x = (xy + xz) * constant(d, 1.0 / 3), y = x - xy, z = x - xz;
  const V off = MulAdd(E.yz, E.yz, MulAdd(E.xz, E.xz, E.xy * E.xy));
  const V diagonal = MulAdd(z, z, MulAdd(y, y, x * x));
  const V p = hn::Max(MulAdd(constant(d, 1.0 / 6), diagonal, constant(d, 1.0 / 3) * off),
                      svd_detail::tiny(d));
  const V size = hn::Sqrt(p);
  const V inverse = one / size;
  const Sym3<V> S = {x * inverse, E.xy * inverse, E.xz * inverse,
                     y * inverse, E.yz * inverse, z * inverse};
  const V det_S = det(S);
  const V c = svd_detail::cos_third(d, hn::Min(hn::Abs(det_S) * half, one));
  const V root = hn::CopySign(c + c, det_S);

  // The projector adj(S − root)/trace; the trace is (root−λ2)(root−λ3) ≥ 3.
  const Sym3<V> adj = adjugate(Sym3<V>{S.xx - root, S.xy, S.xz, S.yy - root, S.yz, S.zz - root});
  const V w = one / ((adj.xx + adj.yy) + adj.zz);
  const Sym3<V> P = {adj.xx * w, adj.xy * w, adj.xz * w, adj.yy * w, adj.yz * w, adj.zz * w};
  // The trace-free remainder N in the plane, eigenvalues ±delta.
  const V half_root = root * half, k = root * constant(d, 1.5);
  const Sym3<V> N = {NegMulAdd(k, P.xx, S.xx + half_root),
                     NegMulAdd(k, P.xy, S.xy),
                     NegMulAdd(k, P.xz, S.xz),
                     NegMulAdd(k, P.yy, S.yy + half_root),
                     NegMulAdd(k, P.yz, S.yz),
                     NegMulAdd(k, P.zz, S.zz + half_root)};
  const V N_off = MulAdd(N.yz, N.yz, MulAdd(N.xz, N.xz, N.xy * N.xy));
  const V N_diagonal = MulAdd(N.zz, N.zz, MulAdd(N.yy, N.yy, N.xx * N.xx));
  const V delta = hn::Sqrt(hn::Max(MulAdd(half, N_diagonal, N_off), svd_detail::tiny(d)));

  const V e1 = MulAdd(size, root, mean);
  const V e2 = MulAdd(size, delta - half_root, mean);
  const V e3 = NegMulAdd(size, delta + half_root, mean);
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
