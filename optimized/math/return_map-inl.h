// SPDX-License-Identifier: BSD-3-Clause
/// Step 7: clamp the singular values of F̂_E to [1−θ_c, 1+θ_s] and move the rest into F_P.

#if defined(FIRN_KERNELS_RETURN_MAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_KERNELS_RETURN_MAP_INL_H_
#undef FIRN_KERNELS_RETURN_MAP_INL_H_
#else
#define FIRN_KERNELS_RETURN_MAP_INL_H_
#endif

#include "optimized/math/elastic_box-inl.h"
#include "optimized/math/svd-inl.h"

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

/// Where a difference is a number other than 0. (Ne leaves open what NaN is: AVX2 and AVX-512 say
/// equal, SSE4 and NEON different.)
template <class D, class V>
HWY_INLINE hn::Mask<D> moved(D d, const V& difference) {
  return Abs(difference) > Zero(d);
}

template <class D, class V>
HWY_INLINE Clamped<V> clamp_stretch(D d, V sigma_minus_1, const ElasticBox<hn::TFromD<D>>& box) {
  const V lo = Set(d, box.lo_minus_1), hi = Set(d, box.hi_minus_1);
  Clamped<V> r;
  r.difference = smaller(larger(sigma_minus_1, lo), hi) - sigma_minus_1;
  r.gamma = r.difference / (constant(d, 1) + sigma_minus_1);
  // Where something is clamped, c is one of two known numbers: no second division.
  const V minus_inverse_c =
      IfThenElse(sigma_minus_1 > hi, Set(d, box.minus_inverse_hi), Set(d, box.minus_inverse_lo));
  r.eta = r.difference * minus_inverse_c;
  return r;
}

/// √(1+ε) − 1 for ε in [−3/4, 3], to an error of about eps ε: the root's rounding error is found
/// from the residual ε − t(t+2) and taken off.
template <class D, class V>
HWY_INLINE V sqrt_one_plus_minus_one(D d, V e) {
  const V one = constant(d, 1);
  const V t = Sqrt(one + e) - one;
  const V residual = NegMulAdd(t, t + constant(d, 2), e);
  // Newton's 1/(2(1+t)) to first order: the correction itself is of the size of one rounding.
  return MulAdd(constant(d, 0.5) * residual, one - t, t);
}

/// tr(A²)/6 of strains that cannot be told from isotropic ones.
template <class T>
inline constexpr double isotropic = sizeof(T) == 4 ? 1e-20 : 1e-40;

/// F_E = F̂(I + Γ), F_P = (I + H) F_P^old, where Γ and H are functions of C = F̂ᵀF̂ = I + E with the
/// eigenvalues c/σ − 1 and σ/c − 1. They come from C's isolated root, the adjugate there and the
/// closed 2x2 remainder: no eigenvectors, no full decomposition. Three stages, so that several
/// vectors can take each of them side by side: one alone mostly waits for its own roots and
/// divisions.
template <class V>
struct ClampState {
  Sym3<V> A;  ///< deviator of E, then the remainder N: A in the plane, trace-free
  Sym3<V>
      adjugate_A;  ///< adj(A − root I), the projector on the isolated eigenvector times its trace
  V mean, half_root;  ///< tr E/3; half the isolated eigenvalue of A
  V inverse_trace;    ///< 1/tr adj(A − root I)
  V delta;            ///< N has the eigenvalues ±delta
};

/// I-coefficient, adjugate-coefficient and N-coefficient of a function of C.
template <class V>
struct ClampFunction {
  V identity, projector, plane;
};

/// Stage 1: the isolated root. Returns the lanes in the range of strains where squaring F̂ costs a
/// few eps at most, and in which J > 0; the others will not hold valid numbers.
template <class D, class V>
HWY_INLINE hn::Mask<D> clamp_root(D d, const Sym3<V>& E, V J_minus_1, ClampState<V>& k) {
  const V one = constant(d, 1), half = constant(d, 0.5);
  k.A = deviator(d, E, k.mean);
  // A deviator far below roundoff of 1 counts as 0; the floor keeps its cube above denormals.
  const V p = larger(deviator_size(d, k.A), constant(d, isotropic<hn::TFromD<D>>));
  const V size = Sqrt(p);
  const V inverse = one / size;
  const V det_A = det(k.A);
  const V h = Abs(det_A) * ((inverse * inverse) * (inverse * half));
  const V c = svd_detail::cos_third(d, smaller(h, one));
  k.half_root = CopySign(size * c, det_A);  // the root of A is 2√p cos θ
  // (root−λ2)(root−λ3) = 3p(4c² − 1) ≥ 6p: known before the adjugate is.
  k.inverse_trace = one / ((p * constant(d, 3)) * MulSub(constant(d, 4), c * c, one));
  const V largest = MulAdd(constant(d, 2), size, Abs(k.mean));  // bounds every eigenvalue of E
  return And(Lt(largest, constant(d, 0.6)), Gt(J_minus_1, constant(d, -1)));
}

/// Stage 2: the adjugate and the plane orthogonal to the isolated eigenvector.
template <class D, class V>
HWY_INLINE void clamp_plane(D d, ClampState<V>& k) {
  const V root = k.half_root + k.half_root;
  const Sym3<V> A = k.A;
  const Sym3<V> adj = adjugate(Sym3<V>{A.xx - root, A.xy, A.xz, A.yy - root, A.yz, A.zz - root});
  // N = A + root/2 I − 3 root/2 P
  const V w = (root + k.half_root) * k.inverse_trace;
  const Sym3<V> N = {NegMulAdd(w, adj.xx, A.xx + k.half_root),
                     NegMulAdd(w, adj.xy, A.xy),
                     NegMulAdd(w, adj.xz, A.xz),
                     NegMulAdd(w, adj.yy, A.yy + k.half_root),
                     NegMulAdd(w, adj.yz, A.yz),
                     NegMulAdd(w, adj.zz, A.zz + k.half_root)};
  const V off = MulAdd(N.yz, N.yz, MulAdd(N.xz, N.xz, N.xy * N.xy));
  const V diagonal = MulAdd(N.zz, N.zz, MulAdd(N.yy, N.yy, N.xx * N.xx));
  const V square = MulAdd(constant(d, 0.5), diagonal, off);
  k.delta = Sqrt(larger(square, constant(d, isotropic<hn::TFromD<D>>)));
  k.adjugate_A = adj;
  k.A = N;
}

/// Stage 3: clamp the three singular values. Returns the lanes in which one of them changed.
template <class D, class V>
HWY_INLINE hn::Mask<D> clamp_values(D d, const ElasticBox<hn::TFromD<D>>& box,
                                    const ClampState<V>& k, ClampFunction<V>& Gamma,
                                    ClampFunction<V>& H) {
  const V half = constant(d, 0.5);
  const V plane = k.mean - k.half_root;
  const V e1 = MulAdd(constant(d, 2), k.half_root, k.mean);
  const Clamped<V> r1 = clamp_stretch(d, sqrt_one_plus_minus_one(d, e1), box);
  const Clamped<V> r2 = clamp_stretch(d, sqrt_one_plus_minus_one(d, plane + k.delta), box);
  const Clamped<V> r3 = clamp_stretch(d, sqrt_one_plus_minus_one(d, plane - k.delta), box);
  // f(C) = f1 P + (f2+f3)/2 (I − P) + (f2−f3)/(2 delta) N
  const V half_by_delta = half / k.delta;
  const auto function = [&](V f1, V f2, V f3) HWY_ATTR {
    const V a = (f2 + f3) * half;
    return ClampFunction<V>{a, (f1 - a) * k.inverse_trace, (f2 - f3) * half_by_delta};
  };
  Gamma = function(r1.gamma, r2.gamma, r3.gamma);
  H = function(r1.eta, r2.eta, r3.eta);
  return Or(Or(moved(d, r1.difference), moved(d, r2.difference)), moved(d, r3.difference));
}

/// The function as a matrix.
template <class V>
HWY_INLINE Sym3<V> evaluate(const ClampFunction<V>& f, const ClampState<V>& k) {
  const Sym3<V>&P = k.adjugate_A, &N = k.A;
  return {MulAdd(f.projector, P.xx, MulAdd(f.plane, N.xx, f.identity)),
          MulAdd(f.projector, P.xy, f.plane * N.xy),
          MulAdd(f.projector, P.xz, f.plane * N.xz),
          MulAdd(f.projector, P.yy, MulAdd(f.plane, N.yy, f.identity)),
          MulAdd(f.projector, P.yz, f.plane * N.yz),
          MulAdd(f.projector, P.zz, MulAdd(f.plane, N.zz, f.identity))};
}

/// The increments of F_E and F_P from the full decomposition F̂ = U Σ̂ Vᵀ, c = clamp(Σ̂):
/// ΔF_E = U (c − Σ̂) Vᵀ and H = V (Σ̂/c − 1) Vᵀ. Any F̂, also singular or inverted.
template <class D, class V>
HWY_NOINLINE void clamp_by_svd(D d, const Mat3<V>& F_hat_minus_I,
                               const ElasticBox<hn::TFromD<D>>& box, Mat3<V>& delta_F_E, Sym3<V>& H,
                               hn::Mask<D>& changed) {
  const V one = constant(d, 1), zero = Zero(d);
  Mat3<V> U, V_, W, Z;
  Vec3<V> sigma;
  svd(d, plus_identity(d, F_hat_minus_I), U, sigma, V_);
  changed = MaskFromVec(zero);
  for (int j = 0; j < 3; ++j) {
    // Comparisons rather than larger() and smaller(): NaN must pass through on every processor.
    const V s = sigma[j] - one, lo = Set(d, box.lo_minus_1), hi = Set(d, box.hi_minus_1);
    const V c = IfThenElse(s > hi, hi, IfThenElse(s < lo, lo, s));
    const V difference = c - s;
    changed = Or(changed, moved(d, difference));
    const V eta = Neg(difference / (one + c));
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

/// F_P = (I + H) F_P^old in the lanes of `changed`; the others keep every bit.
template <class M, class V>
HWY_INLINE void flow_into(M changed, const Sym3<V>& H, Mat3<V>& F_P_minus_I) {
  const Mat3<V> H_full = full(H);
  const Mat3<V> delta = mul_add(H_full, H_full, F_P_minus_I);  // H F_P = H + H (F_P − I)
  for (int k = 0; k < 9; ++k)
    F_P_minus_I.m[k] = IfThenElse(changed, F_P_minus_I.m[k] + delta.m[k], F_P_minus_I.m[k]);
}

/// Step 7 after the trial state, the elastic half: F̂_E − I, with J − 1 = det_minus_one of it,
/// becomes F_E − I with every σ(F_E) in the box, and H = F_E⁻¹F̂_E − I is what flow_into()
/// needs. Only `lanes` are looked at. Returns those in which something was clamped; all other
/// lanes keep every bit, and their H means nothing.
template <ReturnMap path = ReturnMap::fast, class D, class V>
HWY_INLINE hn::Mask<D> clamp_elastic(D d, const ElasticBox<hn::TFromD<D>>& box, hn::Mask<D> lanes,
                                     V J_minus_1, Mat3<V>& F_E_minus_I, Sym3<V>& H) {
  Mat3<V> delta;
  hn::Mask<D> changed, unsafe;
  if constexpr (path == ReturnMap::fast) {
    ClampState<V> k;
    ClampFunction<V> gamma, eta;
    const auto safe = clamp_root(d, right_strain(F_E_minus_I), J_minus_1, k);
    clamp_plane(d, k);
    changed = And(And(lanes, safe), clamp_values(d, box, k, gamma, eta));
    unsafe = AndNot(safe, lanes);
    const Mat3<V> Gamma = full(evaluate(gamma, k));
    delta = mul_add(Gamma, F_E_minus_I, Gamma);  // F̂ Γ = Γ + (F̂ − I) Γ
    H = evaluate(eta, k);
  } else {
    changed = AndNot(lanes, lanes);
    unsafe = lanes;
  }
  if (HWY_UNLIKELY(!AllFalse(d, unsafe))) {
    Mat3<V> delta_svd;
    Sym3<V> H_svd;
    hn::Mask<D> changed_svd;
    clamp_by_svd(d, F_E_minus_I, box, delta_svd, H_svd, changed_svd);
    delta = select(unsafe, delta_svd, delta);
    H = select(unsafe, H_svd, H);
    changed = Or(changed, And(unsafe, changed_svd));
  }
  for (int k = 0; k < 9; ++k)
    F_E_minus_I.m[k] = IfThenElse(changed, F_E_minus_I.m[k] + delta.m[k], F_E_minus_I.m[k]);
  return changed;
}

/// Step 7 after the trial state, whole: in: F̂_E − I and F_P − I; out: F_E − I and F_P − I with
/// F_E F_P = F̂_E F_P^old and every σ(F_E) in the box. Returns the lanes in which something was
/// clamped. J_P = det F_P, so J_P − 1 = det_minus_one() of the new F_P − I.
template <ReturnMap path = ReturnMap::fast, class D, class V>
HWY_INLINE hn::Mask<D> return_map(D d, const ElasticBox<hn::TFromD<D>>& box, Mat3<V>& F_E_minus_I,
                                  Mat3<V>& F_P_minus_I) {
  const V zero = Zero(d);
  Sym3<V> H{zero, zero, zero, zero, zero, zero};
  const auto changed =
      clamp_elastic<path>(d, box, zero <= zero, det_minus_one(F_E_minus_I), F_E_minus_I, H);
  flow_into(changed, H, F_P_minus_I);
  return changed;
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::kernels
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
