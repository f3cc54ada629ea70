// SPDX-License-Identifier: BSD-3-Clause
/// The gather of stages 7 and 8: Σ v_new ⊗ ∂w_ip and Σ (v_new − α vⁿ) w_ip.
///
/// In x the node values are held as value V, difference Δ and second difference S,
/// computed once per block, because with w2 = t + w0 − 2 w3 and w1 = 1 − t − 2 w0 + w3
///   Σ w_a v_a  = V + t Δ + w0 S₁ + w3 S₂        (S₁, S₂ around the two inner nodes)
///   Σ w'_a v_a = Δ + w0' S₁ + w3' S₂
/// 5 multiply-adds for value and derivative instead of 8. A light outer node with
/// a large velocity enters through w0 or w3 alone, so no relative accuracy is lost
/// (a polynomial in t would multiply its velocity by eps instead of by its weight).

#if defined(FIRN_OPTIMIZED_G2P_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_G2P_INL_H_
#undef FIRN_OPTIMIZED_G2P_INL_H_
#else
#define FIRN_OPTIMIZED_G2P_INL_H_
#endif

#include "optimized/math/mat3-inl.h"
#include "optimized/passes/fold-inl.h"
#include "optimized/passes/records-inl.h"
#include "optimized/passes/surroundings-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// Whether the coefficients hold the 4 nodes of every cell in z apart, on a cache line of their
/// own. Where a row fills a line, three out of four rows that start at any node would lie on two
/// lines, and be read twice.
template <class T>
inline constexpr bool cells_apart = row_size<T> * sizeof(T) == 64;
/// From one cell in z to the next, and from one row to the next.
template <class T>
inline constexpr int cell_stride = cells_apart<T> ? row_size<T> : channels<T>;
template <class T>
inline constexpr int row_stride = cells_apart<T> ? block_cells* row_size<T> : tile_row_size<T>;
/// Strides in the coefficients: [x 1…5][y][V, Δ, S][row][z][channel].
template <class T>
inline constexpr int kind_stride = gather_rows<T>* row_stride<T>;
template <class T>
inline constexpr int difference_1 = kind_stride<T>;
template <class T>
inline constexpr int difference_2 = 2 * kind_stride<T>;
template <class T>
inline constexpr int coefficient_y = kinds_in_x* kind_stride<T>;
template <class T>
inline constexpr int coefficient_x = tile_nodes* coefficient_y<T>;

/// Rows that the gather hands to the fold, per particle: three derivatives of every
/// gradient row, and the rows of u.
template <class T>
inline constexpr int gathered_rows = 3 * gradient_rows<T> + gather_rows<T> - gradient_rows<T>;

/// V, Δ and S of the local values; at the last node in x nobody asks for V and Δ.
template <class T>
void difference(const Workspace<T>& work) {
  constexpr int rows = gather_rows<T>;
  const Lanes<T> d;
  constexpr int plane = tile_nodes * rows * tile_row_size<T>;
  for (int y = 0; y < tile_nodes; ++y)
    for (int i = 0; i < rows * row_stride<T>; i += lane_count<T>) {
      const int row = i / row_stride<T>, cell = i / row_size<T> % block_cells;
      const T* from = work.local + y * rows * tile_row_size<T> +
                      (cells_apart<T> ? row * tile_row_size<T> + cell * channels<T> : i);
      T* to = work.coefficients + y * coefficient_y<T> + i;
      auto v = hn::LoadU(d, from + plane);
      auto left = hn::Sub(v, hn::LoadU(d, from));
      for (int x = 1; x <= inner_planes; ++x, to += coefficient_x<T>) {
        const auto next = hn::LoadU(d, from + (x + 1) * plane);
        const auto right = hn::Sub(next, v);
        if (x < inner_planes) hn::Store(v, d, to), hn::Store(right, d, to + difference_1<T>);
        hn::Store(hn::Sub(right, left), d, to + difference_2<T>);
        v = next, left = right;
      }
    }
}

/// What one particle needs to gather, spread out so that each can be broadcast.
template <class T>
struct GatherWeights {
  alignas(cache_line) T t[lane_count<T>], w0[lane_count<T>], w3[lane_count<T>], d0[lane_count<T>],
      d3[lane_count<T>], w_y[stencil_nodes][lane_count<T>], d_y[stencil_nodes][lane_count<T>],
      r[lane_count<T>];
  alignas(cache_line)
      Integer<T> place[lane_count<T>];  ///< of the first stencil row in the coefficients
};

template <class T>
HWY_INLINE void gather_weights(const T* q, GatherWeights<T>& g) {
  constexpr int chunk = chunk_lanes<T>;
  const Lanes<T> d;
  const IntLanes<T> di;
  const auto x = axis_position<T>(q + slot_x * chunk);
  const auto y = axis_position<T>(q + (slot_x + 1) * chunk);
  const auto z = axis_position<T>(q + (slot_x + 2) * chunk);
  const auto wx = axis_weights<T>(x.t, x.o), wy = axis_weights<T>(y.t, y.o);
  hn::Store(x.t, d, g.t), hn::Store(wx.w[0], d, g.w0), hn::Store(wx.w[3], d, g.w3);
  hn::Store(wx.d[0], d, g.d0), hn::Store(wx.d[3], d, g.d3), hn::Store(z.t, d, g.r);
  for (int j = 0; j < stencil_nodes; ++j)
    hn::Store(wy.w[j], d, g.w_y[j]), hn::Store(wy.d[j], d, g.d_y[j]);
  // coefficient_x = 7 coefficient_y: place = (7x + y)·coefficient_y + z·C; 7x = 8x − x.
  static_assert(tile_nodes == 7);
  const auto xy = hn::Add(hn::Sub(hn::ShiftLeft<3>(x.cell), x.cell), y.cell);
  hn::Store(hn::Add(hn::ShiftLeft<cell_bits>(xy), z.cell), di, g.place);
}

/// The rows of one particle, contracted over x and y: Σ w_x w_y v of every row, and of the
/// gradient rows Σ w'_x w_y v and Σ w_x w'_y v as well.
template <class T>
struct Contracted {
  Row<T> value[gather_rows<T>], d_x[gradient_rows<T>], d_y[gradient_rows<T>];
};

/// Rows first … last−1 of them.
template <int first, int last, class T>
HWY_INLINE void contract(const GatherWeights<T>& g, int l, const T* from, Contracted<T>& sum) {
  const Row<T> t = all(g.t + l), w0 = all(g.w0 + l), w3 = all(g.w3 + l);
  const Row<T> d0 = all(g.d0 + l), d3 = all(g.d3 + l);
  for (int j = 0; j < stencil_nodes; ++j, from += coefficient_y<T>) {
    const Row<T> w_y = all(g.w_y[j] + l), dw_y = all(g.d_y[j] + l);
    for (int r = first; r < last; ++r) {
      const T* p = from + r * row_stride<T>;
      const Row<T> slope = load_row(p + difference_1<T>);
      const Row<T> s1 = load_row(p + difference_2<T>);
      const Row<T> s2 = load_row(p + coefficient_x<T> + difference_2<T>);
      const Row<T> b = mul_add(w3, s2, mul_add(w0, s1, mul_add(t, slope, load_row(p))));
      sum.value[r] = j == 0 ? w_y * b : mul_add(w_y, b, sum.value[r]);
      if (r < gradient_rows<T>) {
        const Row<T> e = mul_add(d3, s2, mul_add(d0, s1, slope));
        sum.d_x[r] = j == 0 ? w_y * e : mul_add(w_y, e, sum.d_x[r]);
        sum.d_y[r] = j == 0 ? dw_y * b : mul_add(dw_y, b, sum.d_y[r]);
      }
    }
  }
}

/// One particle: its rows to `out`, `stride` apart.
template <class T>
HWY_INLINE void gather_particle(const ZKernel<T>& kernel, const Row<T>& gradient_lanes,
                                const GatherWeights<T>& g, int l, const T* coefficients, T* out,
                                int stride) {
  constexpr int rows = gather_rows<T>, gradients = gradient_rows<T>;
  const int place = static_cast<int>(g.place[l]);
  const T* from = coefficients + (place >> cell_bits) * coefficient_y<T> +
                  (place & (block_cells - 1)) * cell_stride<T>;
  Contracted<T> sum;
  if constexpr (channels<T> == 1) {  // all 12 sums at once would not fit into 16 registers
    contract<0, gradients>(g, l, from, sum);
    contract<gradients, rows>(g, l, from, sum);
  } else {
    contract<0, rows>(g, l, from, sum);
  }
  Row<T> w, d;
  kernel.weights(g.r + l, w, d);
  for (int r = 0; r < gradients; ++r) {
    store_row(sum.d_x[r] * w, out + 3 * r * stride);
    store_row(sum.d_y[r] * w, out + (3 * r + 1) * stride);
    // A row may hold components of v_new beside one of u: those take w, not w'.
    const bool mixed = (r + 1) * channels<T> > 3;
    Row<T> d_or_w = d;
    if (mixed)
      for (int i = 0; i < row_vectors<T>; ++i)
        d_or_w.part[i] =
            hn::IfThenElse(hn::MaskFromVec(gradient_lanes.part[i]), d.part[i], w.part[i]);
    store_row(sum.value[r] * d_or_w, out + (3 * r + 2) * stride);
  }
  for (int r = gradients; r < rows; ++r)
    store_row(sum.value[r] * w, out + (2 * gradients + r) * stride);
}

/// Of a vector of particles: h ∂v_new/∂x, row-major, and Σ u w.
template <class T>
struct Gathered {
  kernels::HWY_NAMESPACE::Mat3<Vec<T>> gradient;
  Vec<T> u[3];
};

/// The chunk that is read next: each particle asks for a few of its lines, which
/// then arrive behind the arithmetic instead of filling all line buffers at once.
template <class T>
struct ChunkAhead {
  const T* chunk;  ///< nullptr: the block ends before it
  int place;       ///< of the vector at hand within its chunk
  bool plastic;    ///< F_P as well

  HWY_INLINE void prefetch(int l) const {
    if (chunk == nullptr) return;
    // Slots 0 … 31 in equal shares; those of F_P lie in 16 … 23, but for one.
    static_assert(slot_E_P == 15 && slot_tau == 24 && slot_stiffness == 32);
    constexpr int lines = slot_stiffness / chunk_lanes<T>;
    const int first = lines * (place + l);
    if (first == 0) hwy::Prefetch(chunk + slot_stiffness * chunk_lanes<T>);
    if (!plastic && (first & ~7) == slot_E_P + 1) return;
    for (int k = 0; k < lines; ++k) hwy::Prefetch(chunk + (first + k) * chunk_lanes<T>);
  }
};

template <class T>
HWY_INLINE void gather(const ZKernel<T>& kernel, const Row<T>& gradient_lanes, const T* q, int n,
                       const T* coefficients, const ChunkAhead<T>& ahead, Gathered<T>& result) {
  constexpr int L = lane_count<T>, C = channels<T>;
  constexpr int stride = L * row_size<T>;
  GatherWeights<T> g;
  gather_weights(q, g);
  alignas(cache_line) T rows[gathered_rows<T> * stride];
  for (int l = 0; l < n; ++l) {
    ahead.prefetch(l);
    gather_particle(kernel, gradient_lanes, g, l, coefficients, rows + l * row_size<T>, stride);
  }
  if (HWY_UNLIKELY(n < L)) {  // spare lanes hold zeros, so that nothing spills over from old memory
    const Row<T> zeros = per_node<T>(0, 0, 0, 0);
    for (int r = 0; r < gathered_rows<T>; ++r)
      for (int l = n; l < L; ++l) store_row(zeros, rows + r * stride + l * row_size<T>);
  }
  // Channels in order: v_x v_y v_z u_x u_y u_z.
  Vec<T> out[C];
  const auto deliver = [&](int channel, int axis, const Vec<T>& value) HWY_ATTR {
    if (channel < 3) {
      result.gradient(channel, axis) = value;
    } else if (axis == 2 && channel < 6) {
      result.u[channel - 3] = value;
    }
  };
  for (int r = 0; r < gradient_rows<T>; ++r)
    for (int axis = 0; axis < 3; ++axis) {
      fold<T>(rows + (3 * r + axis) * stride, row_size<T>, out);
      for (int c = 0; c < C; ++c) deliver(r * C + c, axis, out[c]);
    }
  for (int r = gradient_rows<T>; r < gather_rows<T>; ++r) {
    fold<T>(rows + (2 * gradient_rows<T> + r) * stride, row_size<T>, out);
    for (int c = 0; c < C; ++c) deliver(r * C + c, 2, out[c]);
  }
}

/// All-ones in the lanes of the last gradient row that hold a component of v_new.
template <class T>
HWY_INLINE Row<T> gradient_lane_mask() {
  alignas(cache_line) T c[row_size<T>];
  for (int i = 0; i < row_size<T>; ++i)
    c[i] = (gradient_rows<T> - 1) * channels<T> + i % channels<T> < 3 ? T(1) : T(0);
  Row<T> r = load_row(c);
  const Lanes<T> d;
  for (int i = 0; i < row_vectors<T>; ++i)
    r.part[i] = hn::VecFromMask(d, hn::Gt(r.part[i], hn::Zero(d)));
  return r;
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
