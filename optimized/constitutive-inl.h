/// Stress and return map of a vector of particles, put together from
/// optimized/kernels: what a lane gets never depends on its neighbours.

#if defined(FIRN_OPTIMIZED_CONSTITUTIVE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_CONSTITUTIVE_INL_H_
#undef FIRN_OPTIMIZED_CONSTITUTIVE_INL_H_
#else
#define FIRN_OPTIMIZED_CONSTITUTIVE_INL_H_
#endif

#include "optimized/kernels/exp-inl.h"
#include "optimized/kernels/return_map-inl.h"
#include "optimized/kernels/stress-inl.h"
#include "optimized/position-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

namespace kn = firn::kernels::HWY_NAMESPACE;

/// What stage 7 changes in a particle, and the stress that follows from it.
template <class T>
struct Deformation {
  kn::Mat3<Vec<T>> E_E, E_P;  ///< F_E − I, F_P − I
  Vec<T> stiffness;           ///< 2 μ V_p0 with μ = μ_0 e^{ξ(1−J_P)}
  kn::Sym3<Vec<T>> tau;       ///< V_p0 P F_Eᵀ
};

/// 2 μ V_p0 with μ = μ_0 e^{ξ(1−J_P)}.
template <class T>
HWY_INLINE Vec<T> stiffness(const MaterialConstants<T>& m, const Vec<T>& V_0,
                            const kn::Mat3<Vec<T>>& E_P) {
  const Lanes<T> d;
  const auto exponent = hn::Mul(hn::Set(d, -m.hardening), kn::det_minus_one(E_P));
  return hn::Mul(hn::Mul(hn::Set(d, m.two_mu_0), V_0), kn::exp(d, exponent));
}

/// V_p0 P F_Eᵀ = 2 μ V_p0 [(F−R)Fᵀ + (λ/2μ)(J−1)J I], from E = FFᵀ − I and J − 1 where
/// the strain is small, from the singular values elsewhere. Returns the small lanes.
template <class T>
HWY_INLINE hn::Mask<Lanes<T>> stress(const MaterialConstants<T>& m, const kn::Sym3<Vec<T>>& E,
                                     const Vec<T>& J_minus_1, Deformation<T>& p) {
  const Lanes<T> d;
  hn::Mask<Lanes<T>> small;
  kn::Sym3<Vec<T>> G = kn::corotated_part(d, E, small);
  small = hn::And(small, hn::Gt(J_minus_1, hn::Set(d, static_cast<T>(-1))));
  if (HWY_UNLIKELY(!hn::AllTrue(d, small))) {
    kn::Sym3<Vec<T>> general;
    kn::corotated_part_svd(d, p.E_E, general);
    G = kn::select(small, G, general);
  }
  const auto pressure = hn::Mul(hn::Set(d, m.lambda_over_2mu),
                                hn::MulAdd(J_minus_1, J_minus_1, J_minus_1));  // (J−1)J
  p.tau.xx = hn::Mul(p.stiffness, hn::Add(G.xx, pressure));
  p.tau.yy = hn::Mul(p.stiffness, hn::Add(G.yy, pressure));
  p.tau.zz = hn::Mul(p.stiffness, hn::Add(G.zz, pressure));
  p.tau.xy = hn::Mul(p.stiffness, G.xy);
  p.tau.xz = hn::Mul(p.stiffness, G.xz);
  p.tau.yz = hn::Mul(p.stiffness, G.yz);
  return small;
}

/// Stage 7, second half: F̂_E to F_E and F_P, and the stress. Particles certified
/// inside the elastic box keep F̂_E and take neither decomposition nor exponential.
/// Returns the lanes whose result is known to be finite.
template <class T>
HWY_INLINE hn::Mask<Lanes<T>> return_map(const MaterialConstants<T>& m, const Vec<T>& V_0,
                                         bool use_certificate, Deformation<T>& p) {
  const Lanes<T> d;
  kn::Sym3<Vec<T>> E = kn::left_strain(p.E_E);
  Vec<T> J_minus_1 = kn::det_minus_one(p.E_E);
  auto inside = kn::inside_elastic_box(d, E, J_minus_1, m.box);
  if (HWY_UNLIKELY(!use_certificate)) inside = hn::Lt(hn::Zero(d), hn::Zero(d));
  if (m.box.bounded && !hn::AllTrue(d, inside)) {
    kn::Mat3<Vec<T>> E_E = p.E_E, E_P = p.E_P;
    const auto changed = hn::AndNot(inside, kn::return_map(d, m.box, E_E, E_P));
    p.E_E = kn::select(changed, E_E, p.E_E);
    p.E_P = kn::select(changed, E_P, p.E_P);
    p.stiffness = hn::IfThenElse(changed, stiffness<T>(m, V_0, E_P), p.stiffness);
    E = kn::left_strain(p.E_E);
    J_minus_1 = kn::det_minus_one(p.E_E);
  }
  return hn::And(inside, stress<T>(m, E, J_minus_1, p));
}

/// Calls f(constants, lanes) for every material among the particles of the vector q.
template <class T, class F>
HWY_INLINE void for_each_material(const StepConstants<T>& step, const T* q, const F& f) {
  const Lanes<T> d;
  const IntLanes<T> di;
  const auto everybody = hn::Eq(hn::Zero(d), hn::Zero(d));
  if (HWY_LIKELY(step.material_count == 1)) return f(step.materials[0], everybody);
  const auto index = hn::BitCast(di, hn::Load(d, q + slot_material * chunk_lanes<T>));
  for (int k = 0; k < step.material_count; ++k) {
    const auto mine = hn::Eq(index, hn::Set(di, static_cast<Integer<T>>(k)));
    if (!hn::AllFalse(di, mine)) f(step.materials[k], hn::RebindMask(d, mine));
  }
}

template <class T>
HWY_INLINE void select_into(const hn::Mask<Lanes<T>>& lanes, const Deformation<T>& yes,
                            Deformation<T>& p) {
  p.E_E = kn::select(lanes, yes.E_E, p.E_E);
  p.E_P = kn::select(lanes, yes.E_P, p.E_P);
  p.stiffness = hn::IfThenElse(lanes, yes.stiffness, p.stiffness);
  p.tau = kn::select(lanes, yes.tau, p.tau);
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
