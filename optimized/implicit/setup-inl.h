/// What the semi-implicit solve prepares once per step: the factors of every particle in
/// cell order, and the preconditioner.

#if defined(FIRN_OPTIMIZED_IMPLICIT_SETUP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_IMPLICIT_SETUP_INL_H_
#undef FIRN_OPTIMIZED_IMPLICIT_SETUP_INL_H_
#else
#define FIRN_OPTIMIZED_IMPLICIT_SETUP_INL_H_
#endif

#include "optimized/implicit/apply-inl.h"
#include "optimized/implicit/fields-inl.h"
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

/// Rows of the stiffness: channels xx yy zz xy xz yz.
template <class S>
inline constexpr int stiffness_rows = gather_rows<S>;

/// Squares of the weights along an axis: w², w'² and w w'.
template <class V>
struct SquaredWeights {
  V w[4], d[4], x[4];
};

template <class S>
HWY_INLINE SquaredWeights<Vec<S>> squared(const AxisWeights<S>& a) {
  SquaredWeights<Vec<S>> s;
  for (int k = 0; k < 4; ++k) {
    s.w[k] = hn::Mul(a.w[k], a.w[k]);
    s.d[k] = hn::Mul(a.d[k], a.d[k]);
    s.x[k] = hn::Mul(a.w[k], a.d[k]);
  }
  return s;
}

/// A particle's share in the stiffness of its 64 nodes, b = μ V_p0, a = (λ + μ) V_p0:
/// with W = w², G = w'², X = w w' along each axis the six channels are, sorted by what
/// depends on x,
///   G_x · (W_z [A, B, B, 0, 0, 0])
/// + W_x · (W_z [C, D, C, 0, 0, 0] + G_z [B, B, A, 0, 0, 0] + X_z [0, 0, 0, 0, 0, E])
/// + X_x · (W_z [0, 0, 0, E, 0, 0] + X_z [0, 0, 0, 0, F, 0]),
/// A = (a+b) W_y, B = b W_y, C = b G_y, D = (a+b) G_y, E = a X_y, F = a W_y.
enum StiffnessRecord : int {
  stiffness_x = 0,    // per x-node: G W X –
  stiffness_y = 16,   // per y-node: the six brackets, 8 values each
  stiffness_r = 208,  // offset in z
  stiffness_record_size = 212
};

template <class S>
HWY_INLINE void stiffness_record(const S* q, S* records) {
  constexpr int L = lane_count<S>, chunk = chunk_lanes<S>;
  const Lanes<S> d;
  S* to[L];
  for (int l = 0; l < L; ++l) to[l] = records + l * stiffness_record_size;
  const auto x = axis_position<S>(q + hessian_x * chunk);
  const auto y = axis_position<S>(q + (hessian_x + 1) * chunk);
  const auto z = axis_position<S>(q + (hessian_x + 2) * chunk);
  const auto b = hn::Mul(hn::Set(d, static_cast<S>(0.5)), hn::Load(d, q + hessian_shear * chunk));
  // λ(2J² − J) stands for λ: equal at J = 1, and the sign is taken off.
  const auto a = hn::Add(b, hn::Abs(hn::Load(d, q + hessian_volume * chunk)));
  const auto both = hn::Add(a, b), zero = hn::Zero(d);
  const auto sx = squared<S>(axis_weights<S>(x.t, x.o)), sy = squared<S>(axis_weights<S>(y.t, y.o));
  for (int k = 0; k < 4; ++k) {
    store_quads<S>(sx.d[k], sx.w[k], sx.x[k], zero, to, stiffness_x + 4 * k);
    const auto A = hn::Mul(both, sy.w[k]), B = hn::Mul(b, sy.w[k]), C = hn::Mul(b, sy.d[k]);
    const auto D = hn::Mul(both, sy.d[k]), E = hn::Mul(a, sy.x[k]), F = hn::Mul(a, sy.w[k]);
    const int at = stiffness_y + 48 * k;
    store_quads<S>(A, B, B, zero, to, at), store_quads<S>(zero, zero, zero, zero, to, at + 4);
    store_quads<S>(C, D, C, zero, to, at + 8), store_quads<S>(zero, zero, zero, zero, to, at + 12);
    store_quads<S>(B, B, A, zero, to, at + 16), store_quads<S>(zero, zero, zero, zero, to, at + 20);
    store_quads<S>(zero, zero, zero, zero, to, at + 24),
        store_quads<S>(zero, E, zero, zero, to, at + 28);
    store_quads<S>(zero, zero, zero, E, to, at + 32),
        store_quads<S>(zero, zero, zero, zero, to, at + 36);
    store_quads<S>(zero, zero, zero, zero, to, at + 40),
        store_quads<S>(F, zero, zero, zero, to, at + 44);
  }
  store_quads<S>(z.t, z.t, z.t, z.t, to, stiffness_r);
}

template <class S>
HWY_INLINE void scatter_stiffness(const ZKernel<S>& kernel, const S* record, S* tile) {
  constexpr int C = channels<S>, R = tile_row_size<S>, rows = stiffness_rows<S>;
  constexpr int row = rows * R, plane = tile_nodes * row;
  Row<S> w, dw;
  kernel.weights(record + stiffness_r, w, dw);
  const Row<S> W = w * w, G = dw * dw, X = w * dw;
  for (int k = 0; k < 4; ++k) {
    const S* y = record + stiffness_y + 48 * k;
    for (int r = 0; r < rows; ++r) {
      const auto bracket = [&](int i) HWY_ATTR { return all_channels(y + 8 * i + r * C); };
      const Row<S> with_G = W * bracket(0);
      const Row<S> with_W = mul_add(X, bracket(3), mul_add(G, bracket(2), W * bracket(1)));
      const Row<S> with_X = mul_add(X, bracket(5), W * bracket(4));
      S* to = tile + k * row + r * R;
      for (int i = 0; i < 4; ++i, to += plane) {
        const S* x = record + stiffness_x + 4 * i;
        store_row(mul_add(all(x), with_G,
                          mul_add(all(x + 1), with_W, mul_add(all(x + 2), with_X, load_row(to)))),
                  to);
      }
    }
  }
}

template <class S>
void stiffness_of_block(const HessianBlock<S>& block, S* tile) {
  constexpr int L = lane_count<S>, C = channels<S>, R = tile_row_size<S>;
  constexpr int row = stiffness_rows<S> * R, plane = tile_nodes * row;
  const ZKernel<S> kernel;
  for (int i = 0; i < tile_nodes * plane; ++i) tile[i] = 0;
  alignas(64) S records[L * stiffness_record_size];
  int cell = 0;
  const int count = block.begin[nodes_per_block];
  for (int i = 0; i < count; i += L) {
    stiffness_record(hessian_vector(block.chunks, i), records);
    for (int l = 0; l < L && i + l < count; ++l) {
      while (i + l >= block.begin[cell + 1]) ++cell;
      scatter_stiffness(kernel, records + l * stiffness_record_size,
                        tile + cell / 16 * plane + cell / 4 % 4 * row + cell % 4 * C);
    }
  }
}

/// P K P + (I − P) for a projector P, which is K where P = I.
template <class V>
HWY_INLINE kn::Sym3<V> restricted(const V& one, const kn::Sym3<V>& K, const kn::Sym3<V>& P) {
  const kn::Mat3<V> A = kn::mul(kn::mul(kn::full(P), kn::full(K)), kn::full(P));
  return {A(0, 0) + (one - P.xx), A(0, 1) - P.xy, A(0, 2) - P.xz,
          A(1, 1) + (one - P.yy), A(1, 2) - P.yz, A(2, 2) + (one - P.zz)};
}

template <class S>
void invert_stiffness(const S* sums, const S* m, double factor, const S* projector, S* inverse) {
  const Lanes<S> d;
  using V = Vec<S>;
  alignas(64) S planar[matrix_size];  // xx yy zz xy xz yz
  separate_rows<S, stiffness_rows<S>>(sums, 6, planar);
  const V one = hn::Set(d, static_cast<S>(1)), factor_ = hn::Set(d, static_cast<S>(factor));
  for (int i = 0; i < nodes_per_block; i += lane_count<S>) {
    const V mass = hn::Load(d, m + i);
    const auto entry = [&](int k) HWY_ATTR {
      const V D = hn::Load(d, planar + k * nodes_per_block + i);
      return where_mass<S>(mass, hn::Div(hn::Mul(factor_, D), mass));
    };
    kn::Sym3<V> K = {one + entry(0), entry(3), entry(4), one + entry(1), entry(5), one + entry(2)};
    kn::Sym3<V> P{};
    if (projector != nullptr) {
      P = load_symmetric(projector, i);
      K = restricted(one, K, P);
    }
    kn::Sym3<V> adj = kn::adjugate(K);
    const V w = one / kn::MulAdd(K.xx, adj.xx, kn::MulAdd(K.xy, adj.xy, K.xz * adj.xz));
    kn::Sym3<V> inv = {adj.xx * w, adj.xy * w, adj.xz * w, adj.yy * w, adj.yz * w, adj.zz * w};
    if (projector != nullptr) {
      const kn::Mat3<V> B = kn::mul(kn::mul(kn::full(P), kn::full(inv)), kn::full(P));
      inv = {B(0, 0), B(0, 1), B(0, 2), B(1, 1), B(1, 2), B(2, 2)};
    }
    const V out[6] = {inv.xx, inv.xy, inv.xz, inv.yy, inv.yz, inv.zz};
    for (int k = 0; k < 6; ++k)
      hn::Store(where_mass<S>(mass, out[k]), d, inverse + k * nodes_per_block + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
