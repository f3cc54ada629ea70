// SPDX-License-Identifier: BSD-3-Clause
/// Elastic energy of a block's particles, from the stress that is at hand.

#if defined(FIRN_OPTIMIZED_MEASURE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_MEASURE_INL_H_
#undef FIRN_OPTIMIZED_MEASURE_INL_H_
#else
#define FIRN_OPTIMIZED_MEASURE_INL_H_
#endif

#include "optimized/passes/records-inl.h"
#include "optimized/passes/slots-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// V_p0 Ψ = 2 μ V_p0 [½‖S − I‖² + ½ (λ/2μ)(J − 1)²] with F_E = R S. The stress holds
/// G = (F−R)Fᵀ = s + s² with s = √(FFᵀ) − I and ‖s‖ = ‖S − I‖; s = G − s² is iterated,
/// which shrinks the error by 2‖s‖ each time: no singular values, and the relative
/// accuracy of a small strain is kept. Lanes with ‖G‖ > 0.1 take the decomposition.
template <class T>
HWY_INLINE Vec<T> elastic_energy(const MaterialConstants<T>& m, const Deformation<Vec<T>>& p,
                                 const Vec<T>& J_minus_1) {
  const Lanes<T> d;
  const auto half = hn::Set(d, static_cast<T>(0.5)), zero = hn::Zero(d);
  const auto ratio = hn::Set(d, m.lambda_over_2mu);
  const auto pressure = hn::Mul(ratio, hn::MulAdd(J_minus_1, J_minus_1, J_minus_1));
  // Without volume there is neither stress nor energy.
  const auto inverse = hn::IfThenElseZero(hn::Gt(p.stiffness, zero),
                                          hn::Div(hn::Set(d, static_cast<T>(1)), p.stiffness));
  const kn::Sym3<Vec<T>> G = {hn::Sub(hn::Mul(p.tau.xx, inverse), pressure),
                              hn::Mul(p.tau.xy, inverse),
                              hn::Mul(p.tau.xz, inverse),
                              hn::Sub(hn::Mul(p.tau.yy, inverse), pressure),
                              hn::Mul(p.tau.yz, inverse),
                              hn::Sub(hn::Mul(p.tau.zz, inverse), pressure)};
  const auto norm2 = [&](const kn::Sym3<Vec<T>>& A) HWY_ATTR {
    const auto off = hn::MulAdd(A.yz, A.yz, hn::MulAdd(A.xz, A.xz, hn::Mul(A.xy, A.xy)));
    const auto on = hn::MulAdd(A.zz, A.zz, hn::MulAdd(A.yy, A.yy, hn::Mul(A.xx, A.xx)));
    return hn::Add(on, hn::Add(off, off));
  };
  // 0.2ⁿ < eps: the strain where ‖s‖ ≈ ‖G‖ ≤ 0.1.
  constexpr int iterations = sizeof(T) == 4 ? 11 : 23;
  kn::Sym3<Vec<T>> s = G;
  for (int k = 0; k < iterations; ++k) {
    const kn::Sym3<Vec<T>> s2 = kn::square(s);
    s = {hn::Sub(G.xx, s2.xx), hn::Sub(G.xy, s2.xy), hn::Sub(G.xz, s2.xz),
         hn::Sub(G.yy, s2.yy), hn::Sub(G.yz, s2.yz), hn::Sub(G.zz, s2.zz)};
  }
  auto s_norm2 = norm2(s);
  const auto small = hn::And(hn::Lt(norm2(G), hn::Set(d, static_cast<T>(0.01))),
                             hn::Gt(J_minus_1, hn::Set(d, static_cast<T>(-1))));
  if (HWY_UNLIKELY(!hn::AllTrue(d, small))) {
    kn::Mat3<Vec<T>> U, V;
    kn::Vec3<Vec<T>> sigma;
    kn::svd(d, kn::plus_identity(d, p.E_E), U, sigma, V);
    auto sum = zero;
    for (int i = 0; i < 3; ++i) {
      const auto e = hn::Sub(sigma[i], hn::Set(d, static_cast<T>(1)));
      sum = hn::MulAdd(e, e, sum);
    }
    s_norm2 = hn::IfThenElse(small, s_norm2, sum);
  }
  const auto volume_part = hn::Mul(ratio, hn::Mul(J_minus_1, J_minus_1));
  return hn::Mul(hn::Mul(p.stiffness, half), hn::Add(s_norm2, volume_part));
}

/// V_p0 Ψ and J_E − 1 of every particle of a block (arrays of its length, rounded up
/// to a whole vector).
template <class T>
void measure_pass(const BlockView<T>& block, const StepConstants<T>& step, T* energy,
                  T* J_minus_1) {
  const Lanes<T> d;
  for (int i = 0; i < block.count; i += lane_count<T>) {
    T* q = vector_of(block, step.slots, i);
    Deformation<Vec<T>> p = load_deformation(OneVector<T>{q});
    const T* tau = q + slot_tau * chunk_lanes<T>;
    p.tau = {hn::Load(d, tau),
             hn::Load(d, tau + chunk_lanes<T>),
             hn::Load(d, tau + 2 * chunk_lanes<T>),
             hn::Load(d, tau + 3 * chunk_lanes<T>),
             hn::Load(d, tau + 4 * chunk_lanes<T>),
             hn::Load(d, tau + 5 * chunk_lanes<T>)};
    const auto J = kn::det_minus_one(p.E_E);
    auto sum = hn::Zero(d);
    for_each_material(step, q, [&](const MaterialConstants<T>& m, const auto& lanes) HWY_ATTR {
      sum = hn::IfThenElse(lanes, elastic_energy<T>(m, p, J), sum);
    });
    hn::Store(sum, d, energy + i);
    hn::Store(J, d, J_minus_1 + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
