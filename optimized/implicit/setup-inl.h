/// What the semi-implicit solve prepares once per step: the factors of every particle in
/// cell order.

#if defined(FIRN_OPTIMIZED_IMPLICIT_SETUP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_IMPLICIT_SETUP_INL_H_
#undef FIRN_OPTIMIZED_IMPLICIT_SETUP_INL_H_
#else
#define FIRN_OPTIMIZED_IMPLICIT_SETUP_INL_H_
#endif

#include "optimized/implicit/apply-inl.h"
#include "optimized/update-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// Spreads one quantity of n particles over their places in cell order.
template <class S>
HWY_INLINE void put(const Vec<S>& value, S* const* to, int slot, int n) {
  alignas(64) S lane[lane_count<S>];
  hn::Store(value, Lanes<S>(), lane);
  for (int l = 0; l < n; ++l) to[l][slot * chunk_lanes<S>] = lane[l];
}

template <class S>
void hessian_factors_of_block(const BlockView<S>& block, const StepConstants<S>& step,
                              std::uint8_t* cells, std::int32_t* begin, S* chunks) {
  constexpr int n = lane_count<S>, chunk = chunk_lanes<S>;
  const Lanes<S> d;
  count_cells(block, step.slots, cells, begin);
  int next[nodes_per_block];
  for (int c = 0; c < nodes_per_block; ++c) next[c] = begin[c];
  for (int i = 0; i < block.count; i += n) {
    const S* q = vector_of(block, step.slots, i);
    const int in_use = block.count - i < n ? block.count - i : n;
    S* to[n];
    for (int l = 0; l < in_use; ++l) {
      const int place = next[cells[i + l]]++;
      to[l] = chunks + place / chunk * (hessian_slots * chunk) + place % chunk;
    }
    const auto two_mu = hn::Load(d, q + slot_stiffness * chunk);
    auto lambda = hn::Zero(d);
    for_each_material(step, q, [&](const MaterialConstants<S>& m, const auto& lanes) HWY_ATTR {
      const auto mine = hn::Mul(hn::Set(d, m.lambda_over_2mu), two_mu);
      lambda = hn::IfThenElse(lanes, mine, lambda);
    });
    const auto f = kn::hessian_factors(d, load_matrix(q, slot_E_E), two_mu, lambda);
    for (int a = 0; a < 3; ++a)
      put<S>(hn::Load(d, q + (slot_x + a) * chunk), to, hessian_x + a, in_use);
    const Vec<S> stretch[6] = {f.stretch.xx, f.stretch.xy, f.stretch.xz,
                               f.stretch.yy, f.stretch.yz, f.stretch.zz};
    const Vec<S> K[6] = {f.K_inverse.xx, f.K_inverse.xy, f.K_inverse.xz,
                         f.K_inverse.yy, f.K_inverse.yz, f.K_inverse.zz};
    for (int k = 0; k < 6; ++k) put<S>(stretch[k], to, hessian_stretch + k, in_use);
    for (int k = 0; k < 6; ++k) put<S>(K[k], to, hessian_K + k, in_use);
    put<S>(f.shear, to, hessian_shear, in_use);
    put<S>(f.volume, to, hessian_volume, in_use);
    put<S>(f.transposed, to, hessian_transposed, in_use);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
