// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/implicit/linearization.hpp"

#include <algorithm>

namespace firn::optimized {

namespace {

template <class S>
void make_room(const ParticleStore<S>& particles, Linearization<S>& result) {
  constexpr std::size_t lanes = chunk_lanes<float>;  // of the longest vector
  const std::size_t active = particles.active().size();
  result.first.resize(active + 1);
  result.first[0] = 0;
  for (std::size_t a = 0; a < active; ++a) {
    const std::size_t count = particles.active_block(a).count;
    result.first[a + 1] = result.first[a] + (count + lanes - 1) / lanes * lanes * hessian_slots;
  }
  // Whichever blocks the particles are in: lanes are left over in each block's last chunk.
  result.factors.require((particles.size() + active * (lanes - 1)) * hessian_slots,
                         active / 8 * lanes * hessian_slots);
  result.begin.require(active * (cells_per_block + 1), active * cells_per_block / 8);
}

/// Slabs begin and end inside of vectors; places are counted from whole cache lines.
template <class S>
std::size_t places_in_slab(const Linearization<S>& result, std::size_t active) {
  std::int32_t largest = 0;
  for (std::size_t a = 0; a < active; ++a) {
    const std::int32_t* begin = result.begin.data() + a * (cells_per_block + 1);
    for (int x = 0; x < block_cells; ++x, begin += cells_per_slab)
      largest = std::max(largest, begin[cells_per_slab] - begin[0]);
  }
  return (static_cast<std::size_t>(largest) / page_particles + 3) * page_particles;
}

}  // namespace

template <class S>
void linearize(ParticleStore<S>& particles, const StepConstants<S>& step,
               const SetupKernels<S>& kernels, int threads, std::vector<ThreadMemory<S>>& memory,
               Linearization<S>& result) {
  make_room(particles, result);
  const std::size_t n = particles.active().size();
#pragma omp parallel for num_threads(threads) schedule(dynamic, blocks_per_turn(n, threads))
  for (std::size_t a = 0; a < n; ++a) {
    ThreadMemory<S>& mine = memory[this_thread()];
    Block<S>& block = particles.active_block(a);
    // A sort keeps the order within a cell, and with it every sum of stages 1 to 5.
    particles.sort(block, mine.sorting);
    kernels.factors(particles.view(block), step, mine.cells.data(),
                    result.begin.data() + a * (cells_per_block + 1),
                    result.factors.data() + result.first[a]);
  }
  result.largest_slab = places_in_slab(result, n);
}

template void linearize(ParticleStore<float>&, const StepConstants<float>&,
                        const SetupKernels<float>&, int, std::vector<ThreadMemory<float>>&,
                        Linearization<float>&);
template void linearize(ParticleStore<double>&, const StepConstants<double>&,
                        const SetupKernels<double>&, int, std::vector<ThreadMemory<double>>&,
                        Linearization<double>&);

}  // namespace firn::optimized
