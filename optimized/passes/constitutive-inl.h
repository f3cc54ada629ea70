// SPDX-License-Identifier: BSD-3-Clause
/// Stress and return map of a vector of particles, put together from
/// optimized/math: what a lane gets never depends on its neighbours.
///
/// The bodies are written for a tag D as those are: one vector, or two side by side
/// (PairOf), of which one computes while the other waits for its roots and divisions.

#if defined(FIRN_OPTIMIZED_CONSTITUTIVE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_CONSTITUTIVE_INL_H_
#undef FIRN_OPTIMIZED_CONSTITUTIVE_INL_H_
#else
#define FIRN_OPTIMIZED_CONSTITUTIVE_INL_H_
#endif

#include "optimized/math/exp-inl.h"
#include "optimized/math/return_map-inl.h"
#include "optimized/math/stress-inl.h"
#include "optimized/passes/position-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

namespace kn = firn::kernels::HWY_NAMESPACE;

/// What stage 7 changes in a particle, and the stress that follows from it.
template <class V>
struct Deformation {
  kn::Mat3<V> E_E, E_P;  ///< F_E − I, F_P − I
  V stiffness;           ///< 2 μ V_p0 with μ = μ_0 e^{ξ(1−J_P)}
  kn::Sym3<V> tau;       ///< V_p0 P F_Eᵀ
};

/// 2 μ V_p0 with μ = μ_0 e^{ξ(1−J_P)}.
template <class D, class V, class T = hn::TFromD<D>>
HWY_INLINE V stiffness(D d, const MaterialConstants<T>& m, V V_0, const kn::Mat3<V>& E_P) {
  const V exponent = Set(d, -m.hardening) * kn::det_minus_one(E_P);
  return (Set(d, m.two_mu_0) * V_0) * kn::exp(d, exponent);
}

/// V_p0 P F_Eᵀ = 2 μ V_p0 [(F−R)Fᵀ + (λ/2μ)(J−1)J I], from E = FFᵀ − I and J − 1 where
/// the strain is small, from the singular values elsewhere. Returns the small lanes.
template <class D, class V, class T = hn::TFromD<D>>
HWY_INLINE hn::Mask<D> stress(D d, const MaterialConstants<T>& m, const kn::Sym3<V>& E, V J_minus_1,
                              Deformation<V>& p) {
  hn::Mask<D> small;
  kn::Sym3<V> G = kn::corotated_part(d, E, small);
  small = And(small, J_minus_1 > Set(d, static_cast<T>(-1)));
  if (HWY_UNLIKELY(!AllTrue(d, small))) {
    kn::Sym3<V> general;
    kn::corotated_part_svd(d, p.E_E, general);
    G = kn::select(small, G, general);
  }
  const V pressure = Set(d, m.lambda_over_2mu) * MulAdd(J_minus_1, J_minus_1, J_minus_1);  // (J−1)J
  p.tau.xx = p.stiffness * (G.xx + pressure);
  p.tau.yy = p.stiffness * (G.yy + pressure);
  p.tau.zz = p.stiffness * (G.zz + pressure);
  p.tau.xy = p.stiffness * G.xy;
  p.tau.xz = p.stiffness * G.xz;
  p.tau.yz = p.stiffness * G.yz;
  return small;
}

/// What decides whether a particle can yield: E = F̂F̂ᵀ − I, J − 1, and the lanes that are
/// certified to lie inside the elastic box.
template <class D>
struct Trial {
  kn::Sym3<hn::Vec<D>> E;
  hn::Vec<D> J_minus_1;
  hn::Mask<D> inside;
};

template <class D, class V, class T = hn::TFromD<D>>
HWY_INLINE Trial<D> examine(D d, const StepConstants<T>& step, const MaterialConstants<T>& m,
                            const kn::Mat3<V>& E_E) {
  Trial<D> trial;
  trial.E = kn::left_strain(E_E);
  trial.J_minus_1 = kn::det_minus_one(E_E);
  trial.inside = kn::inside_elastic_box(d, trial.E, trial.J_minus_1, m.box);
  if (HWY_UNLIKELY(!step.skip.box)) trial.inside = Zero(d) < Zero(d);
  return trial;
}

/// The clamp of the lanes that are not certified: F̂_E to F_E, and the strain that the stress
/// needs. Returns the lanes in which something changed; H is for flow_into().
template <class D, class V, class T = hn::TFromD<D>>
HWY_INLINE hn::Mask<D> clamp(D d, const MaterialConstants<T>& m, Trial<D>& trial, kn::Mat3<V>& E_E,
                             kn::Sym3<V>& H) {
  const auto changed = kn::clamp_elastic(d, m.box, Not(trial.inside), trial.J_minus_1, E_E, H);
  trial.E = kn::left_strain(E_E);
  trial.J_minus_1 = kn::det_minus_one(E_E);
  return changed;
}

/// What the clamp took from F_E goes into F_P. The exponential of the hardening is taken
/// where J_P has changed.
template <class D, class V, class M, class T = hn::TFromD<D>>
HWY_INLINE void flow(D d, const MaterialConstants<T>& m, const M& changed, const kn::Sym3<V>& H,
                     const V& V_0, kn::Mat3<V>& E_P, V& stiff) {
  kn::flow_into(changed, H, E_P);
  stiff = IfThenElse(changed, stiffness(d, m, V_0, E_P), stiff);
}

/// Stage 7, second half: F̂_E to F_E and F_P, and the stress. Particles certified
/// inside the elastic box keep F̂_E and take neither decomposition nor exponential.
/// Returns the lanes whose result is known to be finite.
template <class D, class V, class T = hn::TFromD<D>>
HWY_INLINE hn::Mask<D> return_map(D d, const StepConstants<T>& step, const MaterialConstants<T>& m,
                                  V V_0, Deformation<V>& p) {
  Trial<D> trial = examine(d, step, m, p.E_E);
  if (m.box.bounded && !AllTrue(d, trial.inside)) {
    kn::Sym3<V> H;
    const auto changed = clamp(d, m, trial, p.E_E, H);
    if (HWY_LIKELY(!AllFalse(d, changed))) flow(d, m, changed, H, V_0, p.E_P, p.stiffness);
  }
  if (HWY_UNLIKELY(!step.skip.hardening)) p.stiffness = stiffness(d, m, V_0, p.E_P);
  return And(trial.inside, stress(d, m, trial.E, trial.J_minus_1, p));
}

/// Calls f(constants, lanes) for every material among the particles of the vector q.
template <class T, class F>
HWY_INLINE void for_each_material(const StepConstants<T>& step, const T* q, const F& f) {
  const Lanes<T> d;
  const IntLanes<T> di;
  const auto everybody = hn::Eq(hn::Zero(d), hn::Zero(d));
  if (HWY_LIKELY(step.slots == slots_common)) return f(step.materials[0], everybody);
  const auto index = hn::BitCast(di, hn::Load(d, q + slot_material * chunk_lanes<T>));
  for (int k = 0; k < step.material_count; ++k) {
    const auto mine = hn::Eq(index, hn::Set(di, static_cast<Integer<T>>(k)));
    if (!hn::AllFalse(di, mine)) f(step.materials[k], hn::RebindMask(d, mine));
  }
}

template <class M, class V>
HWY_INLINE void select_into(const M& lanes, const Deformation<V>& yes, Deformation<V>& p) {
  p.E_E = kn::select(lanes, yes.E_E, p.E_E);
  p.E_P = kn::select(lanes, yes.E_P, p.E_P);
  p.stiffness = IfThenElse(lanes, yes.stiffness, p.stiffness);
  p.tau = kn::select(lanes, yes.tau, p.tau);
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
