// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The particles as the operator sees them: what is found of each once per step, from its F_E.

#include <cstdint>
#include <vector>

#include "optimized/implicit/kernel_table.hpp"
#include "optimized/store/memory.hpp"
#include "optimized/store/particle_store.hpp"
#include "optimized/store/thread_memory.hpp"

namespace firn::optimized {

template <class S>
struct Linearization {
  AlignedArray<S> factors;           ///< hessian_slots per particle in chunks, block after block
  std::vector<std::size_t> first;    ///< where each active block's chunks begin
  AlignedArray<std::int32_t> begin;  ///< where each cell of each active block begins, and the end
  std::size_t largest_slab = 0;      ///< places for the particles of an x-slab

  /// The particles of active block a.
  HessianBlock<S> block(const ParticleStore<S>& particles, std::size_t a) const {
    return {particles.view(particles.active_block(a)), static_cast<int>(particles.slots()),
            factors.data() + first[a], begin.data() + a * (cells_per_block + 1)};
  }

  std::size_t bytes() const {
    return factors.bytes() + first.capacity() * sizeof(first[0]) + begin.bytes();
  }
};

/// Linearizes about the particles' F_E, and puts each block's particles in cell order.
template <class S>
void linearize(ParticleStore<S>& particles, const StepConstants<S>& step,
               const SetupKernels<S>& kernels, int threads, std::vector<ThreadMemory<S>>& memory,
               Linearization<S>& result);

}  // namespace firn::optimized
