// SPDX-License-Identifier: BSD-3-Clause
/// What the semi-implicit solve prepares once per step: the factors of every particle.

#if defined(FIRN_OPTIMIZED_IMPLICIT_SETUP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_IMPLICIT_SETUP_INL_H_
#undef FIRN_OPTIMIZED_IMPLICIT_SETUP_INL_H_
#else
#define FIRN_OPTIMIZED_IMPLICIT_SETUP_INL_H_
#endif

#include "optimized/implicit/apply-inl.h"
#include "optimized/passes/slots-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// Lanes behind the last particle get harmless numbers.
template <class S>
void hessian_factors_of_block(const BlockView<S>& block, const StepConstants<S>& step,
                              std::uint8_t* cells, std::int32_t* begin, S* factors) {
  constexpr int n = lane_count<S>, chunk = chunk_lanes<S>;
  const Lanes<S> d;
  count_cells(block, step.slots, cells, begin);
  for (int i = 0; i < block.count; i += n) {
    const S* q = vector_of(block, step.slots, i);
    S* const to = factors_of(factors, i);
    const auto two_mu = hn::Load(d, q + slot_stiffness * chunk);
    auto lambda = hn::Zero(d);
    for_each_material(step, q, [&](const MaterialConstants<S>& m, const auto& lanes) HWY_ATTR {
      const auto mine = hn::Mul(hn::Set(d, m.lambda_over_2mu), two_mu);
      lambda = hn::IfThenElse(lanes, mine, lambda);
    });
    const auto f = kn::hessian_factors(d, load_matrix(q, slot_E_E), two_mu, lambda);
    const Vec<S> stretch[6] = {f.stretch.xx, f.stretch.xy, f.stretch.xz,
                               f.stretch.yy, f.stretch.yz, f.stretch.zz};
    const Vec<S> K[6] = {f.K_inverse.xx, f.K_inverse.xy, f.K_inverse.xz,
                         f.K_inverse.yy, f.K_inverse.yz, f.K_inverse.zz};
    const auto put = [&](int slot, const Vec<S>& x)
                         HWY_ATTR { hn::Store(x, d, to + slot * chunk); };
    for (int k = 0; k < 6; ++k) put(hessian_stretch + k, stretch[k]);
    for (int k = 0; k < 6; ++k) put(hessian_K + k, K[k]);
    put(hessian_volume, f.volume);
    put(hessian_transposed, f.transposed);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
