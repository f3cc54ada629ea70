// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The per-particle kernels over arrays: for tests, benchmarks and anybody who wants
/// only the decomposition. The solver calls the -inl.h kernels directly.
///
/// Layout: packets of 32 particles. Component k of particle i of an array with `rows`
/// components stands at [((i / 32)·rows + k)·32 + i mod 32]. Matrices are row-major with 9 rows,
/// symmetric ones have 6 (xx, xy, xz, yy, yz, zz). A half-empty packet is the caller's to fill.

#include <cstddef>

#include "optimized/math/elastic_box.hpp"

namespace firn::kernels {

inline constexpr std::size_t packet_size = 32;  ///< two vectors of 16 floats

/// The kernels of one instruction set.
template <class T>
struct BatchKernels {
  const char* target;  ///< name of the instruction set, compiled in
  std::size_t lanes;   ///< matrices per vector

  /// A = U diag(σ) Vᵀ in stages over several vectors: hides the latency of roots and divisions.
  void (*svd)(const T* A, T* U, T* sigma, T* V, std::size_t packets);
  /// The same vector by vector, as the solver's fallback calls it.
  void (*svd_plain)(const T* A, T* U, T* sigma, T* V, std::size_t packets);
  /// The same with one lane.
  void (*svd_scalar)(const T* A, T* U, T* sigma, T* V, std::size_t packets);
  /// R of any F, and R of F near a rotation.
  void (*polar)(const T* F, T* R, std::size_t packets);
  void (*polar_near_rotation)(const T* F, T* R, std::size_t packets);
  /// inside = 1 or 0, from F − I.
  void (*inside_elastic_box)(const T* F_minus_I, const ElasticBox<T>& box, T* inside,
                             std::size_t packets);
  void (*exp)(const T* x, T* y, std::size_t packets);
  /// τ [Pa] from F_E − I; μ, λ [Pa] one per particle.
  void (*kirchhoff_stress)(const T* F_E_minus_I, const T* mu, const T* lambda, T* tau,
                           std::size_t packets);
  /// 15 numbers per particle (stretch 6, K⁻¹ 6, shear, volume, transposed) from F_E − I, 2μ V_p0
  /// and λ V_p0; and V_p0 A F_Eᵀ from them and velocity gradients L.
  void (*hessian_factors)(const T* F_E_minus_I, const T* two_mu, const T* lambda, T* factors,
                          std::size_t packets);
  void (*hessian_action)(const T* factors, const T* L, T* result, std::size_t packets);
  /// Step 7 in place; changed = 1 or 0.
  void (*return_map)(const ElasticBox<T>& box, T* F_E_minus_I, T* F_P_minus_I, T* changed,
                     std::size_t packets);
  /// The same with one lane, and by full decompositions only.
  void (*return_map_scalar)(const ElasticBox<T>& box, T* F_E_minus_I, T* F_P_minus_I, T* changed,
                            std::size_t packets);
  void (*return_map_svd)(const ElasticBox<T>& box, T* F_E_minus_I, T* F_P_minus_I, T* changed,
                         std::size_t packets);
};

/// The kernels of the best instruction set that this processor has (T: float or double), or of the
/// one that hwy::SetSupportedTargetsForTest left standing.
template <class T>
const BatchKernels<T>& batch_kernels();

}  // namespace firn::kernels
