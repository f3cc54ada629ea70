/// Stages 7, 8 and 10: a block's particles from the node values around it.

#if defined(FIRN_OPTIMIZED_UPDATE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_UPDATE_INL_H_
#undef FIRN_OPTIMIZED_UPDATE_INL_H_
#else
#define FIRN_OPTIMIZED_UPDATE_INL_H_
#endif

#include "optimized/constitutive-inl.h"
#include "optimized/g2p-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

template <class T>
HWY_INLINE kn::Mat3<Vec<T>> load_matrix(const T* q, int slot) {
  const Lanes<T> d;
  kn::Mat3<Vec<T>> A;
  for (int i = 0; i < 9; ++i) A.m[i] = hn::Load(d, q + (slot + i) * chunk_lanes<T>);
  return A;
}

template <class T>
HWY_INLINE void store_matrix(const kn::Mat3<Vec<T>>& A, T* q, int slot) {
  const Lanes<T> d;
  for (int i = 0; i < 9; ++i) hn::Store(A.m[i], d, q + (slot + i) * chunk_lanes<T>);
}

/// Lanes 0 … n−1 in which every one of the values is finite.
template <class T>
HWY_INLINE hn::Mask<Lanes<T>> finite(const Vec<T>* value, int count) {
  const Lanes<T> d;
  auto sum = hn::Zero(d);  // 0·x is 0 or NaN
  for (int i = 0; i < count; ++i) sum = hn::MulAdd(value[i], hn::Zero(d), sum);
  return hn::Eq(sum, hn::Zero(d));
}

/// Notes the first lane below n that is not in `good`, if no fault is known yet.
template <class T>
HWY_INLINE void expect(const hn::Mask<Lanes<T>>& good, int i, int n, Fault fault,
                       FaultReport& report) {
  const Lanes<T> d;
  const auto bad = hn::And(hn::Not(good), hn::FirstN(d, static_cast<std::size_t>(n)));
  if (HWY_LIKELY(hn::AllFalse(d, bad)) || report.fault != Fault::none) return;
  report.fault = fault;
  report.place = i + static_cast<int>(hn::FindFirstTrue(d, bad));
}

template <class T>
HWY_INLINE Deformation<T> load_deformation(const T* q) {
  const Lanes<T> d;
  Deformation<T> p;
  p.E_E = load_matrix(q, slot_E_E);
  p.E_P = load_matrix(q, slot_E_P);
  p.stiffness = hn::Load(d, q + slot_stiffness * chunk_lanes<T>);
  p.tau = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  return p;
}

template <class T>
HWY_INLINE void store_stress(const Deformation<T>& p, T* q) {
  const Lanes<T> d;
  constexpr int chunk = chunk_lanes<T>;
  hn::Store(p.stiffness, d, q + slot_stiffness * chunk);
  const Vec<T> tau[6] = {p.tau.xx, p.tau.xy, p.tau.xz, p.tau.yy, p.tau.yz, p.tau.zz};
  for (int k = 0; k < 6; ++k) hn::Store(tau[k], d, q + (slot_tau + k) * chunk);
}

/// The return map where a vector may hold particles of several materials. Apart from
/// the common case, which need not copy anything.
template <class T>
HWY_NOINLINE hn::Mask<Lanes<T>> return_map_of_mixture(const StepConstants<T>& step, const T* q,
                                                      const Vec<T>& V_0, Deformation<T>& p) {
  const Lanes<T> d;
  const Deformation<T> trial = p;
  auto good = hn::Eq(V_0, V_0);
  for_each_material(step, q, [&](const MaterialConstants<T>& m, const auto& lanes) HWY_ATTR {
    Deformation<T> mine = trial;
    const auto mine_good = return_map<T>(m, V_0, step.certify, mine);
    select_into<T>(lanes, mine, p);
    good = hn::And(good, hn::Or(mine_good, hn::Not(lanes)));
  });
  (void)d;
  return good;
}

/// F̂_E = (I + Δt ∇v) F_E, in E = F − I: Ê = E + g + g E with g = Δt ∇v; then the
/// return map.
template <class T>
HWY_INLINE void deform(const StepConstants<T>& step, const Gathered<T>& gathered, T* q, int i,
                       int n, FaultReport& report) {
  const Lanes<T> d;
  const auto dt_over_h = hn::Set(d, step.dt_over_h);
  kn::Mat3<Vec<T>> g;
  for (int k = 0; k < 9; ++k) g.m[k] = hn::Mul(gathered.gradient[k], dt_over_h);
  Deformation<T> p = load_deformation(q);
  p.E_E = kn::trial_deformation(p.E_E, g);
  const auto V_0 = hn::Load(d, q + slot_V_0 * chunk_lanes<T>);
  const auto good = HWY_LIKELY(step.material_count == 1)
                        ? return_map<T>(step.materials[0], V_0, step.certify, p)
                        : return_map_of_mixture(step, q, V_0, p);
  if (!hn::AllTrue(d, good))
    expect<T>(hn::And(finite<T>(p.E_E.m, 9), finite<T>(p.E_P.m, 9)), i, n, Fault::deformation,
              report);
  store_matrix(p.E_E, q, slot_E_E);
  store_matrix(p.E_P, q, slot_E_P);
  store_stress(p, q);
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

template <class T>
int update(const BlockView<T>& block, const StepConstants<T>& step, const Workspace<T>& work,
           int passes, FaultReport& report) {
  const Lanes<T> d;
  constexpr int L = lane_count<T>;
  const ZKernel<T> kernel;
  const Row<T> gradient_lanes = gradient_lane_mask<T>();
  int leavers = 0;
  for (int i = 0; i < block.count; i += L) {
    T* q = vector_of(block, step.slots, i);
    const int n = block.count - i < L ? block.count - i : L;
    if (i % chunk_lanes<T> == 0)
      prefetch_chunk(block, step.slots, i + chunk_lanes<T>, 0, step.slots);
    if (passes & (pass_deformation | pass_velocity)) {
      Gathered<T> gathered;
      gather(kernel, gradient_lanes, q, n, work.coefficients, gathered);
      if (passes & pass_deformation) deform(step, gathered, q, i, n, report);
      if (passes & pass_velocity) blend_velocity(step, gathered, q, i, n, report);
    }
    if (passes & pass_position) {
      const auto stays = move(step, block, q, i, n, report);
      const auto leaves = hn::And(hn::Not(stays), hn::FirstN(d, static_cast<std::size_t>(n)));
      if (HWY_UNLIKELY(!hn::AllFalse(d, leaves))) {
        alignas(64) T flag[L];
        hn::Store(hn::IfThenElseZero(leaves, hn::Set(d, T(1))), d, flag);
        for (int l = 0; l < n; ++l)
          if (flag[l] != 0) work.leavers[leavers++] = i + l;
      }
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
    const auto V_0 = hn::Load(d, q + slot_V_0 * chunk_lanes<T>);
    Deformation<T> p = load_deformation(q);
    for_each_material(step, q, [&](const MaterialConstants<T>& m, const auto& lanes) HWY_ATTR {
      Deformation<T> mine = p;
      mine.stiffness = stiffness<T>(m, V_0, p.E_P);
      stress<T>(m, kn::left_strain(p.E_E), kn::det_minus_one(p.E_E), mine);
      select_into<T>(lanes, mine, p);
    });
    store_stress(p, q);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
