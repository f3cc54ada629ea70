// SPDX-License-Identifier: BSD-3-Clause
/// First half of the semi-implicit operator: the gradient of a node field at particles, gathered as
/// in stage 7. The form of the sums in x is that of g2p-inl.h, for 3 channels instead of 6.

#if defined(FIRN_OPTIMIZED_IMPLICIT_GRADIENT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_IMPLICIT_GRADIENT_INL_H_
#undef FIRN_OPTIMIZED_IMPLICIT_GRADIENT_INL_H_
#else
#define FIRN_OPTIMIZED_IMPLICIT_GRADIENT_INL_H_
#endif

#include "optimized/implicit/layout.hpp"
#include "optimized/passes/row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

/// Rows of a vector field: 3 channels.
template <class T>
inline constexpr int vector_rows = force_rows<T>;
/// Values per stencil row of a tile, and per plane.
template <class T>
inline constexpr int vector_row = vector_rows<T>* tile_row_size<T>;
template <class T>
inline constexpr int vector_plane = tile_nodes* vector_row<T>;
/// From one y to the next in the coefficients, [x 1…5][y][V, Δ, S][row][z][channel], and in a
/// slab's moments, [y][n0, s0, s1, n3][row][z][channel].
template <class T>
inline constexpr int gradient_y = kinds_in_x* vector_row<T>;
template <class T>
inline constexpr int moment_y = sums_in_x* vector_row<T>;

/// What a vector of particles is multiplied by, one quantity after the other, a value per lane:
/// each is read as one number for a whole row, so that nothing has to be transposed.
enum HessianWeight : int {
  weight_y = 0,      ///< 4 weights
  derivative_y = 4,  ///< 4 derivatives
  weight_t = 8,      ///< offset in x, outer weights and derivatives in x
  weight_x0 = 9,
  weight_x3 = 10,
  derivative_x0 = 11,
  derivative_x3 = 12
};
static_assert(hessian_weights == 13);

/// Places in a particle's record. τ' = V_p0 A F_Eᵀ is not symmetric: three whole columns.
enum HessianRecord : int {
  hessian_record_x = 0,  // τ'00 τ'10 τ'20 –
  hessian_record_y = 4,
  hessian_record_z = 8,
  hessian_record_w_z = 12,  // 4 weights
  hessian_record_d_z = 16,  // 4 derivatives
};

/// Weights of the particle in place i of the slab, lane_count apart.
template <class T>
HWY_INLINE T* weights_of(const HessianScratch<T>& work, int i) {
  constexpr auto L = static_cast<unsigned>(lane_count<T>);
  const auto u = static_cast<unsigned>(i);  // so that / and % are a shift and a mask
  return work.weights + u / L * (hessian_weights * L) + u % L;
}
template <class T>
HWY_INLINE Row<T> weight(const T* of_particle, int which) {
  return all(of_particle + which * lane_count<T>);
}

/// V, Δ and S of the local values.
template <class T>
void vector_difference(const HessianScratch<T>& work) {
  const Lanes<T> d;
  for (int x = 1; x <= inner_planes; ++x)
    for (int y = 0; y < tile_nodes; ++y) {
      const T* from = work.local + x * vector_plane<T> + y * vector_row<T>;
      T* to = work.coefficients + ((x - 1) * tile_nodes + y) * gradient_y<T>;
      for (int i = 0; i < vector_row<T>; i += lane_count<T>) {
        const auto v = hn::Load(d, from + i);
        const auto right = hn::Sub(hn::Load(d, from + vector_plane<T> + i), v);
        const auto left = hn::Sub(v, hn::Load(d, from - vector_plane<T> + i));
        hn::Store(v, d, to + i);
        hn::Store(right, d, to + vector_row<T> + i);
        hn::Store(hn::Sub(right, left), d, to + 2 * vector_row<T> + i);
      }
    }
}

/// The weights of one particle, each in a whole row.
template <class T>
struct OneParticle {
  const T* of;
  HWY_INLINE Row<T> operator()(int which) const { return weight(of, which); }
};
/// Those of as many particles as a row has channels, side by side.
template <class T>
struct OneParticlePerChannel {
  const T* of;
  HWY_INLINE Row<T> operator()(int which) const { return all_channels(of + which * lane_count<T>); }
};

/// A row, contracted over x and y: Σ w_x w_y u, Σ w'_x w_y u and Σ w_x w'_y u.
template <class T>
struct ContractedRow {
  Row<T> value, d_x, d_y;
};

/// `rows` rows from `from` on, contracted `count` times with different weights: what is read of the
/// nodes is read once. (On AVX-512 most of these loads cross a cache line and cost as much as two.)
template <int count, int rows, class T, class Weights>
HWY_INLINE void contract(const Weights* weights, const T* from, ContractedRow<T> (*sum)[rows]) {
  Row<T> t[count], w0[count], w3[count], d0[count], d3[count];
  for (int k = 0; k < count; ++k) {
    t[k] = weights[k](weight_t), w0[k] = weights[k](weight_x0), w3[k] = weights[k](weight_x3);
    d0[k] = weights[k](derivative_x0), d3[k] = weights[k](derivative_x3);
  }
  for (int j = 0; j < stencil_nodes; ++j, from += gradient_y<T>) {
    Row<T> w_y[count], dw_y[count];
    for (int k = 0; k < count; ++k)
      w_y[k] = weights[k](weight_y + j), dw_y[k] = weights[k](derivative_y + j);
    for (int r = 0; r < rows; ++r) {
      const T* const p = from + r * tile_row_size<T>;
      const Row<T> v = load_row(p), slope = load_row(p + vector_row<T>);
      const Row<T> s1 = load_row(p + 2 * vector_row<T>);
      const Row<T> s2 = load_row(p + tile_nodes * gradient_y<T> + 2 * vector_row<T>);
      for (int k = 0; k < count; ++k) {
        const Row<T> b = mul_add(w3[k], s2, mul_add(w0[k], s1, mul_add(t[k], slope, v)));
        const Row<T> e = mul_add(d3[k], s2, mul_add(d0[k], s1, slope));
        ContractedRow<T>& to = sum[k][r];
        to.value = j == 0 ? w_y[k] * b : mul_add(w_y[k], b, to.value);
        to.d_y = j == 0 ? dw_y[k] * b : mul_add(dw_y[k], b, to.d_y);
        to.d_x = j == 0 ? w_y[k] * e : mul_add(w_y[k], e, to.d_x);
      }
    }
  }
}

/// Times the weights in z: the row's three derivatives, `stride` apart.
template <class T>
HWY_INLINE ContractedRow<T> times_z(const ContractedRow<T>& row, const Row<T>& w, const Row<T>& d) {
  return {row.value * d, row.d_x * w, row.d_y * w};
}
template <class T>
HWY_INLINE void store_derivatives(const ContractedRow<T>& row, T* out, int stride) {
  store_row(row.d_x, out), store_row(row.d_y, out + stride), store_row(row.value, out + 2 * stride);
}

/// h ∇u at one particle with weights `of`: 3·vector_rows rows to `out`, `stride` apart.
template <class T>
HWY_INLINE void gather_particle(const T* of, const T* record, const T* from, T* out, int stride) {
  const OneParticle<T> particle{of};
  ContractedRow<T> sum[1][vector_rows<T>];
  contract<1>(&particle, from, sum);
  const Row<T> w = each_node(record + hessian_record_w_z);
  const Row<T> d = each_node(record + hessian_record_d_z);
  for (int r = 0; r < vector_rows<T>; ++r)
    store_derivatives(times_z(sum[0][r], w, d), out + 3 * r * stride, stride);
}

/// Whether two neighbours in a cell are gathered together: where that saves loads that cross cache
/// lines, and where the second row of either would hold one component and nothing.
template <class T>
inline constexpr bool in_pairs = HWY_MAX_BYTES == 64 || channels<T> == 2;

/// The same for two consecutive particles of one cell. With two channels, the third components of
/// both share a row: u_z lies in either of its channels (pack_vector).
template <class T>
HWY_INLINE void gather_pair(const T* of, const T* record, const T* from, T* out, int stride) {
  const OneParticle<T> particle[2] = {{of}, {of + 1}};
  ContractedRow<T> sum[2][1];
  if constexpr (HWY_MAX_BYTES == 64) {
    contract<2>(particle, from, sum);
  } else {  // 16 registers do not hold both
    contract<1>(particle, from, sum), contract<1>(particle + 1, from, sum + 1);
  }
  Row<T> w[2], d[2];
  for (int k = 0; k < 2; ++k) {
    w[k] = each_node(record + k * hessian_record_size + hessian_record_w_z);
    d[k] = each_node(record + k * hessian_record_size + hessian_record_d_z);
    store_derivatives(times_z(sum[k][0], w[k], d[k]), out + k * row_size<T>, stride);
  }
  if constexpr (channels<T> == 2) {
    const OneParticlePerChannel<T> both{of};
    contract<1>(&both, from + tile_row_size<T>, sum);
    const ContractedRow<T> z =
        times_z(sum[0][0], one_per_channel(w[0], w[1]), one_per_channel(d[0], d[1]));
    out += 3 * stride;
    store_derivatives(z, out, stride);
    store_derivatives(
        ContractedRow<T>{other_channel(z.value), other_channel(z.d_x), other_channel(z.d_y)},
        out + row_size<T>, stride);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
