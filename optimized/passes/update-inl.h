// SPDX-License-Identifier: BSD-3-Clause
/// Stages 7, 8 and 10: a block's particles from the node values around it.

#if defined(FIRN_OPTIMIZED_UPDATE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_UPDATE_INL_H_
#undef FIRN_OPTIMIZED_UPDATE_INL_H_
#else
#define FIRN_OPTIMIZED_UPDATE_INL_H_
#endif

#include "optimized/passes/g2p-inl.h"
#include "optimized/passes/slots-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// The return map where a vector may hold particles of several materials. Apart from
/// the common case, which need not copy anything.
template <class T>
HWY_NOINLINE hn::Mask<Lanes<T>> return_map_of_mixture(const StepConstants<T>& step, const T* q,
                                                      const Vec<T>& V_0, Deformation<Vec<T>>& p) {
  const Lanes<T> d;
  const Deformation<Vec<T>> trial = p;
  auto good = hn::Eq(V_0, V_0);
  for_each_material(step, q, [&](const MaterialConstants<T>& m, const auto& lanes) HWY_ATTR {
    Deformation<Vec<T>> mine = trial;
    const auto mine_good = return_map(d, step, m, V_0, mine);
    select_into(lanes, mine, p);
    good = hn::And(good, hn::Or(mine_good, hn::Not(lanes)));
  });
  return good;
}

/// Notes what deform() could not vouch for; `good` of one vector or of two.
template <class T>
HWY_INLINE void expect_finite(const OneVector<T>& at, const hn::Mask<Lanes<T>>& good, int i, int n,
                              FaultReport& report) {
  if (HWY_LIKELY(hn::AllTrue(Lanes<T>(), good))) return;
  const kn::Mat3<Vec<T>> E_E = load_matrix(at, slot_E_E), E_P = load_matrix(at, slot_E_P);
  expect<T>(hn::And(finite<T>(E_E.m, 9), finite<T>(E_P.m, 9)), i, n, Fault::deformation, report);
}
template <class T>
HWY_INLINE void expect_finite(const TwoVectors<T>& at, const kn::MaskPair<hn::Mask<Lanes<T>>>& good,
                              int i, int n, FaultReport& report) {
  constexpr int L = lane_count<T>;
  expect_finite(OneVector<T>{at.a}, good.a, i, L, report);
  expect_finite(OneVector<T>{at.b}, good.b, i + L, n - L, report);
}

/// F̂_E = (I + Δt ∇v) F_E, in E = F − I: Ê = E + g + g E with g = Δt ∇v; then the
/// return map. F_P and the stiffness are touched only where something may yield.
/// Returns whether that was so.
template <class Place, class V, class T>
HWY_INLINE bool deform(const StepConstants<T>& step, const kn::Mat3<V>& h_gradient, const Place& at,
                       int i, int n, FaultReport& report) {
  const typename Place::Tag d;
  const MaterialConstants<T>& m = step.materials[0];
  kn::Mat3<V> g;
  for (int k = 0; k < 9; ++k) g.m[k] = h_gradient.m[k] * Set(d, step.dt_over_h);
  Deformation<V> p;
  p.E_E = kn::trial_deformation(load_matrix(at, slot_E_E), g);
  // Most vectors that are not at rest show it in the first entry.
  if (step.skip.rest && HWY_UNLIKELY(AllTrue(d, Abs(p.E_E.m[0]) <= Zero(d)))) {
    V size = Abs(p.E_E.m[1]);
    for (int k = 2; k < 9; ++k) size = size + Abs(p.E_E.m[k]);
    if (AllTrue(d, size <= Zero(d))) {  // not for NaN
      store_matrix(p.E_E, at, slot_E_E);
      store_tau<Place, V>({Zero(d), Zero(d), Zero(d), Zero(d), Zero(d), Zero(d)}, at);
      return false;
    }
  }
  Trial<typename Place::Tag> trial = examine(d, step, m, p.E_E);
  p.stiffness = load_slot(at, slot_stiffness);
  const bool yields = m.box.bounded && !AllTrue(d, trial.inside);
  if (yields || HWY_UNLIKELY(!step.skip.plastic || !step.skip.hardening)) {
    kn::Sym3<V> H;
    auto changed = Not(trial.inside);
    if (yields) changed = clamp(d, m, trial, p.E_E, H);
    const V V_0 = load_slot(at, slot_V_0);
    p.E_P = load_matrix(at, slot_E_P);
    if (yields) flow(d, m, changed, H, V_0, p.E_P, p.stiffness);
    if (HWY_UNLIKELY(!step.skip.hardening)) p.stiffness = stiffness(d, m, V_0, p.E_P);
    store_matrix(p.E_P, at, slot_E_P);
    store_slot(p.stiffness, at, slot_stiffness);
  }
  const auto good = And(trial.inside, stress(d, m, trial.E, trial.J_minus_1, p));
  store_matrix(p.E_E, at, slot_E_E);
  store_tau(p.tau, at);
  expect_finite(at, good, i, n, report);
  return yields;
}

/// The same where the scene has several materials.
template <class T>
HWY_INLINE void deform_mixture(const StepConstants<T>& step, const kn::Mat3<Vec<T>>& h_gradient,
                               T* q, int i, int n, FaultReport& report) {
  const Lanes<T> d;
  const OneVector<T> at{q};
  kn::Mat3<Vec<T>> g;
  for (int k = 0; k < 9; ++k) g.m[k] = h_gradient.m[k] * hn::Set(d, step.dt_over_h);
  Deformation<Vec<T>> p = load_deformation(at);
  p.E_E = kn::trial_deformation(p.E_E, g);
  const auto good = return_map_of_mixture(step, q, load_slot(at, slot_V_0), p);
  store_matrix(p.E_E, at, slot_E_E);
  store_matrix(p.E_P, at, slot_E_P);
  store_slot(p.stiffness, at, slot_stiffness);
  store_tau(p.tau, at);
  expect_finite(at, good, i, n, report);
}

/// v_p = (1−α) Σ v_new w + α (v_p + Σ (v_new − vⁿ) w) = α v_p + Σ u w.
template <class T>
HWY_INLINE void blend_velocity(const StepConstants<T>& step, const Gathered<T>& gathered, T* q,
                               int i, int n, FaultReport& report) {
  const Lanes<T> d;
  const auto flip = hn::Set(d, step.flip);
  Vec<T> v[3];
  for (int a = 0; a < 3; ++a) {
    T* at = q + (slot_v + a) * chunk_lanes<T>;
    v[a] = hn::MulAdd(flip, hn::Load(d, at), gathered.u[a]);
    hn::Store(v[a], d, at);
  }
  expect<T>(finite<T>(v, 3), i, n, Fault::velocity, report);
}

/// x_p += Δt v_p. Returns the lanes that are no longer inside the block.
template <class T>
HWY_INLINE hn::Mask<Lanes<T>> move(const StepConstants<T>& step, const BlockView<T>& block, T* q,
                                   int i, int n, FaultReport& report) {
  const Lanes<T> d;
  const auto dt_over_h = hn::Set(d, step.dt_over_h);
  auto stays = hn::FirstN(d, static_cast<std::size_t>(n));
  auto slow = stays;
  for (int a = 0; a < 3; ++a) {
    T* x = q + (slot_x + a) * chunk_lanes<T>;
    const auto displacement = hn::Mul(hn::Load(d, q + (slot_v + a) * chunk_lanes<T>), dt_over_h);
    slow = hn::And(slow, hn::Lt(hn::Abs(displacement), hn::Set(d, static_cast<T>(block_cells))));
    const auto moved_x = moved<T>(x, displacement);
    stays = hn::And(stays, inside<T>(moved_x, block.limit[a]));
    hn::Store(moved_x, d, x);
  }
  expect<T>(slow, i, n, Fault::position, report);
  return stays;
}

/// Whether two vectors side by side pay: not with 16 registers, where every second
/// operation of theirs would be a move to or from the stack.
inline constexpr bool side_by_side = HWY_ARCH_ARM || HWY_MAX_BYTES == 64;

/// Stages 7 and 8 of one vector after the other or, where that pays, of two side by side.
/// Returns whether something may have yielded.
template <class T>
HWY_INLINE bool deform_vectors(const StepConstants<T>& step, const Gathered<T>* gathered,
                               T* const* q, int i, int n, FaultReport& report) {
  constexpr int L = lane_count<T>;
  if (HWY_UNLIKELY(step.slots > slots_common)) {
    deform_mixture(step, gathered[0].gradient, q[0], i, n < L ? n : L, report);
    if (n > L) deform_mixture(step, gathered[1].gradient, q[1], i + L, n - L, report);
    return true;
  }
  if (!side_by_side || HWY_UNLIKELY(n <= L)) {
    bool yields = deform(step, gathered[0].gradient, OneVector<T>{q[0]}, i, n < L ? n : L, report);
    if (n > L)
      yields |= deform(step, gathered[1].gradient, OneVector<T>{q[1]}, i + L, n - L, report);
    return yields;
  }
  kn::Mat3<kn::Pair<Vec<T>>> gradient;
  for (int k = 0; k < 9; ++k)
    gradient.m[k] = {gathered[0].gradient.m[k], gathered[1].gradient.m[k]};
  return deform(step, gradient, TwoVectors<T>{q[0], q[1]}, i, n, report);
}

/// Appends the lanes that move() did not keep.
template <class T>
HWY_INLINE int note_leavers(const hn::Mask<Lanes<T>>& stays, int i, int n, std::int32_t* leavers,
                            int known) {
  const Lanes<T> d;
  const auto leaves = hn::And(hn::Not(stays), hn::FirstN(d, static_cast<std::size_t>(n)));
  if (HWY_LIKELY(hn::AllFalse(d, leaves))) return known;
  alignas(cache_line) T flag[lane_count<T>];
  hn::Store(hn::IfThenElseZero(leaves, hn::Set(d, T(1))), d, flag);
  for (int l = 0; l < n; ++l)
    if (flag[l] != 0) leavers[known++] = i + l;
  return known;
}

template <class T>
int update(const BlockView<T>& block, const StepConstants<T>& step, const Workspace<T>& work,
           int passes, FaultReport& report) {
  constexpr int L = lane_count<T>;
  constexpr int ahead = 2 * L > chunk_lanes<T> ? 2 * L : chunk_lanes<T>;
  const ZKernel<T> kernel;
  const Row<T> gradient_lanes = gradient_lane_mask<T>();
  int leavers = 0;
  bool yields = true;
  for (int i = 0; i < block.count; i += 2 * L) {
    const int n = block.count - i < 2 * L ? block.count - i : 2 * L;
    const int part[2] = {n < L ? n : L, n - L};
    T* const q[2] = {vector_of(block, step.slots, i), vector_of(block, step.slots, i + L)};
    Gathered<T> gathered[2];
    if (passes & (pass_deformation | pass_velocity)) {
      for (int k = 0; k < 2 && part[k] > 0; ++k) {
        const int next = i + k * L + ahead;
        const ChunkAhead<T> chunk_ahead{
            next < block.count ? vector_of(block, step.slots, next - next % chunk_lanes<T>)
                               : nullptr,
            (i + k * L) % chunk_lanes<T>, yields};
        gather(kernel, gradient_lanes, q[k], part[k], work.coefficients, chunk_ahead, gathered[k]);
      }
      if (passes & pass_deformation) yields = deform_vectors(step, gathered, q, i, n, report);
    }
    for (int k = 0; k < 2 && part[k] > 0; ++k) {
      const int first = i + k * L;
      if (passes & pass_velocity) blend_velocity(step, gathered[k], q[k], first, part[k], report);
      if (passes & pass_position)
        leavers = note_leavers<T>(move(step, block, q[k], first, part[k], report), first, part[k],
                                  work.leavers, leavers);
    }
  }
  return leavers;
}

/// The stress of F_E and the stiffness of F_P as they stand, without plastic flow.
template <class T>
void stress_pass(const BlockView<T>& block, const StepConstants<T>& step) {
  const Lanes<T> d;
  for (int i = 0; i < block.count; i += lane_count<T>) {
    T* q = vector_of(block, step.slots, i);
    const OneVector<T> at{q};
    const Vec<T> V_0 = load_slot(at, slot_V_0);
    Deformation<Vec<T>> p = load_deformation(at);
    for_each_material(step, q, [&](const MaterialConstants<T>& m, const auto& lanes) HWY_ATTR {
      const Vec<T> other_stiffness = p.stiffness;
      const kn::Sym3<Vec<T>> other_tau = p.tau;
      p.stiffness = stiffness(d, m, V_0, p.E_P);
      stress(d, m, kn::left_strain(p.E_E), kn::det_minus_one(p.E_E), p);
      p.stiffness = IfThenElse(lanes, p.stiffness, other_stiffness);
      p.tau = kn::select(lanes, p.tau, other_tau);
    });
    store_slot(p.stiffness, at, slot_stiffness);
    store_tau(p.tau, at);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
