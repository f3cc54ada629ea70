// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/implicit/system.hpp"

#include <algorithm>

namespace firn::optimized {

namespace {

/// Numbers of a thread's scratch memory for applying the operator, in any type.
template <class S>
std::size_t scratch_size(const Linearization<S>& linearization) {
  return vector_moments_size + vector_local_size + vector_coefficients_size +
         linearization.largest_slab * (hessian_weights + hessian_record_size);
}

/// In the memory of the explicit step's records.
template <class T, class S>
HessianScratch<T> scratch_of_this_thread(const LinearSystem<S>& system) {
  const ThreadMemory<S>& thread = system.scratch[this_thread()];
  const std::size_t slab = system.memory.linearization.largest_slab;
  Arena arena(thread.numbers.lend());
  HessianScratch<T> s;
  s.moments = arena.take<T>(vector_moments_size);
  s.local = arena.take<T>(vector_local_size);
  s.coefficients = arena.take<T>(vector_coefficients_size);
  s.weights = arena.take<T>(slab * hessian_weights);
  s.records = arena.take<T>(slab * hessian_record_size);
  return s;
}

template <class S>
void find_anchors(const LinearSystem<S>& system) {
  if constexpr (std::is_same_v<S, double>) {
    std::vector<Defect>& defects = system.memory.defects;
    const std::size_t n = system.particles.active().size();
    defects.resize(n);
#pragma omp parallel for num_threads(system.threads) schedule(static)
    for (std::size_t a = 0; a < n; ++a)
      defects[a].anchor = anchor_of(system.particles, system.particles.active_block(a));
  }
}

}  // namespace

template <class S>
LinearSystem<S> assemble(ParticleStore<S>& particles, NodeStore<S>& nodes,
                         const StepConstants<S>& step, double factor,
                         const ImplicitKernels<S>& kernels, int threads,
                         std::vector<ThreadMemory<S>>& scratch, ImplicitMemory<S>& memory) {
  memory.partial.require(nodes.size(), nodes.size() / 8);
  memory.sums.resize(threads);
  const LinearSystem<S> system = {
      particles, nodes,   kernels,
      memory,    scratch, borrow_vectors(nodes, particles.active().size(), kernels),
      factor,    threads};
  linearize(particles, step, kernels.setup, threads, scratch, memory.linearization);
  find_anchors(system);
  const std::size_t bytes = scratch_size(memory.linearization) * sizeof(double);
  for (ThreadMemory<S>& thread : scratch) thread.require_bytes(bytes, bytes / 8);
  return system;
}

template <class T, class S>
void apply_hessian(const LinearSystem<S>& system) {
  const HessianKernels<T, S>& kernels = system.kernels.template hessian<T>();
  const OperatorFields<T>& fields = system.vectors.template in<T>();
  const std::size_t n = system.particles.active().size();
#pragma omp parallel for num_threads(system.threads) \
    schedule(dynamic, blocks_per_turn(n, system.threads))
  for (std::size_t a = 0; a < n; ++a) {
    const HessianScratch<T> work = scratch_of_this_thread<T>(system);
    system.nodes.load_surroundings(
        a, kernels, [&](std::size_t k) { return fields.gathered[k]; }, work.local);
    kernels.difference(work);
    T* const tile = fields.tiles[a];
    kernels.apply(system.memory.linearization.block(system.particles, a), work, tile);
    if constexpr (sizeof(T) < sizeof(S)) kernels.total(tile, system.memory.defects[a].total);
  }
}

template <class T, class S>
const FieldType<T, S>* hessian_at(const LinearSystem<S>& system, std::size_t n,
                                  ThreadSums<S>& sums) {
  using Field = FieldType<T, S>;
  const HessianKernels<T, S>& kernels = system.kernels.template hessian<T>();
  const Pieces<T>& tiles = system.vectors.template in<T>().tiles;
  auto& [interleaved, planar] = std::get<FieldSums<Field>>(sums);
  std::fill_n(interleaved, kernels.sums_size, Field(0));
  for (const Share& share : system.nodes.shares(n))
    kernels.add_tile(tiles[share.tile_number], share.region, interleaved);
  kernels.planar(interleaved, planar);
  if constexpr (sizeof(T) < sizeof(S)) {
    for (const Share& share : system.nodes.shares(n)) {
      const Defect& defect = system.memory.defects[share.tile_number];
      const int node = node_in_region(share.region, defect.anchor);
      if (node < 0) continue;
      for (int axis = 0; axis < 3; ++axis)
        planar[axis * nodes_per_block + node] -= defect.total[axis];
    }
  }
  return planar;
}

template LinearSystem<float> assemble(ParticleStore<float>&, NodeStore<float>&,
                                      const StepConstants<float>&, double,
                                      const ImplicitKernels<float>&, int,
                                      std::vector<ThreadMemory<float>>&, ImplicitMemory<float>&);
template LinearSystem<double> assemble(ParticleStore<double>&, NodeStore<double>&,
                                       const StepConstants<double>&, double,
                                       const ImplicitKernels<double>&, int,
                                       std::vector<ThreadMemory<double>>&, ImplicitMemory<double>&);
template void apply_hessian<float>(const LinearSystem<float>&);
template void apply_hessian<double>(const LinearSystem<float>&);
template void apply_hessian<float>(const LinearSystem<double>&);
template void apply_hessian<double>(const LinearSystem<double>&);
template const float* hessian_at<float>(const LinearSystem<float>&, std::size_t,
                                        ThreadSums<float>&);
template const double* hessian_at<double>(const LinearSystem<float>&, std::size_t,
                                          ThreadSums<float>&);
template const double* hessian_at<float>(const LinearSystem<double>&, std::size_t,
                                         ThreadSums<double>&);
template const double* hessian_at<double>(const LinearSystem<double>&, std::size_t,
                                          ThreadSums<double>&);

}  // namespace firn::optimized
