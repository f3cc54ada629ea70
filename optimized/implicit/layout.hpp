#pragma once
/// Memory of the semi-implicit solve, shared by its drivers and its kernels.
///
/// S is the type in which the solver stores its particles, T the type in which an
/// operator is applied: T = S in the iteration, T = double where residuals are found.

#include "optimized/layout.hpp"

namespace firn::optimized {

/// What the Hessian's action needs of a particle; positions do not change during a
/// solve, so particles lie in cell order. In chunks, as in ParticleStore.
enum HessianSlot : int {
  hessian_x = 0,           ///< position inside the block (3)
  hessian_stretch = 3,     ///< left stretch √(F_E F_Eᵀ): 00 01 02 11 12 22 (6)
  hessian_K = 9,           ///< (tr(stretch) I − stretch)⁻¹ (6)
  hessian_shear = 15,      ///< 2μ V_p0 [J]
  hessian_volume = 16,     ///< λ(J² + (J−1)J) V_p0 [J]
  hessian_transposed = 17  ///< λ(J−1)J V_p0 [J]
};
inline constexpr int hessian_slots = 18;

/// The particles of one block as the operator sees them.
template <class S>
struct HessianBlock {
  S* chunks;
  const std::int32_t* begin;  ///< where each of the 64 cells begins, and the end
};

/// Scratch memory of one thread for applying the operator in type T.
template <class T>
struct HessianScratch {
  T* records;       ///< record_size per particle
  T* moments;       ///< one x-slab of the scatter
  T* local;         ///< the node values around a block
  T* coefficients;  ///< their difference form
};

/// A vector at the nodes of one node block, planar: [axis][node].
inline constexpr int field_size = 3 * nodes_per_block;
/// A symmetric matrix at the nodes of one node block, planar: [xx xy xz yy yz zz][node].
inline constexpr int matrix_size = 6 * nodes_per_block;

}  // namespace firn::optimized
