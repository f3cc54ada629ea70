// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Memory of the semi-implicit solve, shared by its drivers and its kernels.
///
/// S is the type in which the solver stores its particles, T the type in which an
/// operator is applied: float in the iteration, double where residuals are found. Its forces are
/// added up, and everything else of the solve is done, in the wider of both.

#include <type_traits>

#include "optimized/store/layout.hpp"

namespace firn::optimized {

/// The type of the fields that an operator in T acts upon.
template <class T, class S>
using FieldType = std::conditional_t<(sizeof(T) < sizeof(S)), S, T>;

/// What the Hessian's action needs of a particle beside its position and slot_stiffness,
/// 2μ V_p0, which are read where they lie. In chunks, as in ParticleStore.
enum HessianSlot : int {
  hessian_stretch = 0,     ///< left stretch √(F_E F_Eᵀ): 00 01 02 11 12 22 (6)
  hessian_K = 6,           ///< (tr(stretch) I − stretch)⁻¹ (6)
  hessian_volume = 12,     ///< λ(J² + (J−1)J) V_p0 [J]
  hessian_transposed = 13  ///< λ(J−1)J V_p0 [J]
};
inline constexpr int hessian_slots = 14;

/// The particles of one block, which lie in cell order, as the operator sees them.
template <class S>
struct HessianBlock {
  BlockView<S> particles;
  int slots;                  ///< per particle
  const S* factors;           ///< chunks of hessian_slots
  const std::int32_t* begin;  ///< where each of the block's cells begins, and the end
};

/// Numbers per particle while an x-slab is worked upon: weights, and a record of what it scatters.
inline constexpr int hessian_weights = 13;
inline constexpr int hessian_record_size = 20;

/// Scratch memory of one thread for applying the operator in type T.
template <class T>
struct HessianScratch {
  T* weights;       ///< hessian_weights per particle of an x-slab, and of two vectors more
  T* records;       ///< hessian_record_size of the same
  T* moments;       ///< one x-slab of the scatter
  T* local;         ///< the node values around a block
  T* coefficients;  ///< their difference form
};

/// Values that a node's rows of a vector field hold at most.
inline constexpr int vector_values = 4;
/// Bounds on the lengths of moments, local values and coefficients.
inline constexpr int vector_moments_size = tile_nodes * sums_in_x * vector_values * tile_row;
inline constexpr int vector_local_size = tile_nodes * tile_nodes * vector_values * tile_row;
inline constexpr int vector_coefficients_size =
    inner_planes * tile_nodes * kinds_in_x * vector_values * tile_row;

/// A vector at the nodes of one node block, planar: [axis][node].
inline constexpr int field_size = 3 * nodes_per_block;
template <class T>
struct BlockField {
  T v[3][nodes_per_block];
};
/// A symmetric matrix at the nodes of one node block, planar: [xx xy xz yy yz zz][node].
inline constexpr int matrix_size = 6 * nodes_per_block;

}  // namespace firn::optimized
