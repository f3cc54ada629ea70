// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The kernels as the drivers see them: one table of functions per precision and
/// instruction set, chosen at run time. Everything crosses as plain pointers.

#include "optimized/store/layout.hpp"

namespace firn::optimized {

template <class T>
struct KernelTable {
  const char* target;  ///< name of the instruction set
  TileShape shape;

  /// Stage 1 and 3: m, m v and V P Fᵀ of the block's particles onto its tile. `next`, if
  /// any, is the block that the caller is likely to scatter next.
  void (*scatter)(const BlockView<T>&, const BlockView<T>* next, const StepConstants<T>&,
                  const Workspace<T>&, T* tile);

  /// A region of a tile added to a node block's sums.
  void (*add_tile)(const T* tile, const Region&, T* sums);

  /// A node block's sums (rows as in a tile, 4 nodes in z), which started from zero, to planar
  /// momentum, mass and Σ A ∂w; the sums are zero again afterwards.
  void (*planar)(T* sums, NodeFields<T>&);

  /// Stage 1: v_i = (m v)_i / m_i.
  void (*node_velocities)(NodeFields<T>&);
  /// Stage 3: f_i = −(1/h) Σ A ∂w.
  void (*node_forces)(const StepConstants<T>&, NodeFields<T>&);
  /// Stage 4: v_i* = v_i + Δt (f_i/m_i + g).
  void (*node_velocities_star)(const StepConstants<T>&, NodeFields<T>&);
  /// (v_new, u = v_new − α v) in the order in which blocks gather them; whether v_new is finite.
  bool (*pack_gathered)(const StepConstants<T>&, const NodeMotion<T>&, T* gathered);

  /// The node values around a block, from the 8 node blocks that it meets or, at
  /// the end of a period that is no multiple of 4, region by region.
  void (*load_local)(const T* const gathered[tile_corners], T* local);
  void (*load_region)(const T* gathered, const Region&, T* local);
  /// Their difference form.
  void (*difference)(const Workspace<T>&);
  /// Stages 7, 8, 10 as `passes` says. Returns the number of leavers in the workspace.
  int (*update)(const BlockView<T>&, const StepConstants<T>&, const Workspace<T>&, int passes,
                FaultReport&);

  /// V P Fᵀ and the hardened stiffness of every particle, whatever F_E is.
  void (*stress)(const BlockView<T>&, const StepConstants<T>&);

  /// V_p0 Ψ and J_E − 1 of every particle.
  void (*measure)(const BlockView<T>&, const StepConstants<T>&, T* energy, T* J_minus_1);
};

/// The table for the instruction set in use.
const KernelTable<float>& float_kernels();
const KernelTable<double>& double_kernels();

template <class T>
const KernelTable<T>& kernels();
template <>
inline const KernelTable<float>& kernels<float>() {
  return float_kernels();
}
template <>
inline const KernelTable<double>& kernels<double>() {
  return double_kernels();
}

}  // namespace firn::optimized
