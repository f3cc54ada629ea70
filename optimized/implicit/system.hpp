// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The linear system of the semi-implicit update on blocks and tiles,
///   B v = v*,   B v = v + βΔt² M⁻¹H v   (Stomakhin et al. 2013, section 6),
/// without a matrix: what a particle needs is found once per step (linearization.hpp), and applying
/// H is one gather and one scatter. The reference's step_06_integration.cpp has the derivation.

#include "optimized/implicit/memory.hpp"
#include "optimized/implicit/vectors.hpp"

namespace firn::optimized {

/// The system of one step: everything is somebody else's, and lent until it is solved.
template <class S>
struct LinearSystem {
  const ParticleStore<S>& particles;
  const NodeStore<S>& nodes;
  const ImplicitKernels<S>& kernels;
  ImplicitMemory<S>& memory;
  const std::vector<ThreadMemory<S>>& scratch;  ///< of each thread
  SolveVectors<S> vectors;
  double factor;  ///< βΔt²/h²
  int threads;
};

/// Linearizes about the particles' F_E, and puts each block's particles in cell order.
/// `factor` is βΔt²/h². Tiles and gathered fields lose what they hold.
template <class S>
LinearSystem<S> assemble(ParticleStore<S>& particles, NodeStore<S>& nodes,
                         const StepConstants<S>& step, double factor,
                         const ImplicitKernels<S>& kernels, int threads,
                         std::vector<ThreadMemory<S>>& scratch, ImplicitMemory<S>& memory);

/// H in type T times what was packed into vectors.in<T>().gathered, onto the tiles.
template <class T, class S>
void apply_hessian(const LinearSystem<S>& system);

/// The tiles' sum at node block n: h² times H of what was packed, planar, in `sums`.
template <class T, class S>
const FieldType<T, S>* hessian_at(const LinearSystem<S>& system, std::size_t n,
                                  ThreadSums<S>& sums);

/// Σ over node blocks of f(n, sums of this thread), added in their order.
template <class S, class F>
double sum_over_nodes(const LinearSystem<S>& system, const F& f) {
  const std::size_t blocks = system.nodes.size();
  double* const partial = system.memory.partial.data();
#pragma omp parallel for num_threads(system.threads) schedule(static)
  for (std::size_t n = 0; n < blocks; ++n) partial[n] = f(n, system.memory.sums[this_thread()]);
  double sum = 0;
  for (std::size_t n = 0; n < blocks; ++n) sum += partial[n];
  return sum;
}

/// f(n) for every node block.
template <class S, class F>
void for_each_node_block(const LinearSystem<S>& system, const F& f) {
  const std::size_t blocks = system.nodes.size();
#pragma omp parallel for num_threads(system.threads) schedule(static)
  for (std::size_t n = 0; n < blocks; ++n) f(n);
}

}  // namespace firn::optimized
