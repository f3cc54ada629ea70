#include "optimized/implicit/system.hpp"

#include <algorithm>
#include <cmath>
#include <omp.h>

namespace firn::optimized {

template <class S>
void ImplicitSystem<S>::release(std::size_t node_blocks) {
  held_.require(node_blocks);
  projector_.require(node_blocks * matrix_size);
  exact_projector_.require(node_blocks * matrix_size);
  std::fill_n(held_.data(), node_blocks, std::uint8_t(0));
}

template <class S>
void ImplicitSystem<S>::set_free_directions(std::size_t n, int k, const Mat3& P) {
  const auto set = [&](int node, const Mat3& A) {
    const double entries[6] = {A(0, 0), A(0, 1), A(0, 2), A(1, 1), A(1, 2), A(2, 2)};
    for (int e = 0; e < 6; ++e) {
      const std::size_t i = n * matrix_size + static_cast<std::size_t>(e * nodes_per_block + node);
      exact_projector_[i] = entries[e];
      projector_[i] = static_cast<S>(entries[e]);
    }
  };
  if (held_[n] == 0) {
    for (int i = 0; i < nodes_per_block; ++i) set(i, Mat3::Identity());
    held_[n] = 1;
  }
  set(k, P);
}

template <class S>
Mat3 ImplicitSystem<S>::free_directions(std::size_t n, int k) const {
  if (!held(n)) return Mat3::Identity();
  const auto at = [&](int e) {
    return exact_projector_[n * matrix_size + static_cast<std::size_t>(e * nodes_per_block + k)];
  };
  Mat3 P;
  P << at(0), at(1), at(2), at(1), at(3), at(4), at(2), at(4), at(5);
  return P;
}

template <class S>
void ImplicitSystem<S>::remember_v_star(const NodeStore<S>& nodes) {
  v_star_.require(nodes.size() * field_size);
  for (std::size_t n = 0; n < nodes.size(); ++n)
    std::copy_n(&nodes.fields(n).v_star[0][0], field_size, v_star(n));
}

template <class S>
void ImplicitSystem<S>::assemble(const ParticleStore<S>& particles, NodeStore<S>& nodes,
                                 const StepConstants<S>& step, double factor) {
  particles_ = &particles;
  nodes_ = &nodes;
  factor_ = factor;
  const std::size_t n = nodes.size();
  v_.require(n * field_size), residual_.require(n * field_size), partial_.require(n);
  for (AlignedArray<S>* field : {&z_last_, &z_, &w_last_, &w_, &d_}) field->require(n * field_size);
  thread_.resize(static_cast<std::size_t>(threads_));
  for (Thread& thread : thread_) {
    const auto particles_at_most = static_cast<std::size_t>(particles.largest_block());
    thread.cells.require(particles_at_most + 2 * page_particles);
    thread.numbers.require((particles_at_most + 2 * page_particles) * record_size + moments_size +
                           local_size + coefficients_size);
    // Spare lanes read what was never written: any number will do, but a number.
    std::fill_n(thread.numbers.data(), thread.numbers.bytes() / sizeof(double), 0.0);
    thread.field.require(static_cast<std::size_t>(local_size + field_size));
  }
  factor_particles(step);
}

template <class S>
void ImplicitSystem<S>::factor_particles(const StepConstants<S>& step) {
  const std::vector<int>& active = particles_->active();
  constexpr std::size_t lanes = chunk_lanes<S>;
  first_.resize(active.size() + 1);
  first_[0] = 0;
  for (std::size_t a = 0; a < active.size(); ++a) {
    const auto count = static_cast<std::size_t>(particles_->block(active[a]).count);
    first_[a + 1] = first_[a] + (count + lanes - 1) / lanes * lanes * hessian_slots;
  }
  // Only the lanes left over in each block's last chunk vary: half of it in spare would be waste.
  chunks_.require(first_.back(), first_.back() / 16);
  begin_.require(active.size() * (nodes_per_block + 1));
  const SetupKernels<S>& kernels = setup_kernels<S>();
  const int n = static_cast<int>(active.size());
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 4)
  for (int i = 0; i < n; ++i) {
    const auto a = static_cast<std::size_t>(i);
    const Block<S>& block = particles_->block(active[a]);
    S* const chunks = chunks_.data() + first_[a];
    // Lanes behind the last particle compute harmless numbers.
    const std::size_t last_chunk = lanes * hessian_slots;
    std::fill_n(chunks_.data() + first_[a + 1] - last_chunk, last_chunk, S(0));
    kernels.factors(particles_->view(block), step,
                    thread_[static_cast<std::size_t>(omp_get_thread_num())].cells.data(),
                    begin_.data() + a * (nodes_per_block + 1), chunks);
  }
}

template <class S>
template <class T>
HessianScratch<T> ImplicitSystem<S>::scratch(Thread& thread) const {
  HessianScratch<T> s;
  s.moments = reinterpret_cast<T*>(thread.numbers.data());
  s.local = s.moments + moments_size;
  s.coefficients = s.local + local_size;
  s.records = s.coefficients + coefficients_size;
  return s;
}

template <class S>
template <class T>
void ImplicitSystem<S>::apply() {
  const HessianKernels<T, S>& kernels = hessian_kernels<T, S>();
  const int n = static_cast<int>(particles_->active().size());
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 4)
  for (int i = 0; i < n; ++i) {
    const auto a = static_cast<std::size_t>(i);
    const HessianScratch<T> work =
        scratch<T>(thread_[static_cast<std::size_t>(omp_get_thread_num())]);
    const Surroundings& s = nodes_->surroundings(a);
    if (s.first_region < 0) {
      const T* from[8];
      for (std::size_t k = 0; k < 8; ++k)
        from[k] = gathered<T>(static_cast<std::size_t>(s.node_block[k]));
      kernels.load_local(from, work.local);
    } else {
      for (int k = 0; k < s.region_count; ++k) {
        const auto& from = nodes_->regions(s)[k];
        kernels.load_region(gathered<T>(static_cast<std::size_t>(from.node_block)), from.region,
                            work.local);
      }
    }
    kernels.difference(work);
    kernels.apply({chunks_.data() + first_[a], begin_.data() + a * (nodes_per_block + 1)}, work,
                  reinterpret_cast<T*>(nodes_->tile(a)));
  }
}

template <class S>
template <class T>
const T* ImplicitSystem<S>::applied(std::size_t n, Thread& thread) const {
  const HessianKernels<T, S>& kernels = hessian_kernels<T, S>();
  T* const field = reinterpret_cast<T*>(thread.field.data());
  T* const sums = field + field_size;
  std::fill_n(sums, kernels.sums_size, T(0));
  const NodeBlock& block = nodes_->block(n);
  const Share* share = nodes_->shares(block);
  for (int k = 0; k < block.share_count; ++k)
    kernels.add_tile(
        reinterpret_cast<const T*>(nodes_->tile(static_cast<std::size_t>(share[k].tile_number))),
        share[k].region, sums);
  kernels.planar(sums, field);
  return field;
}

template <class S>
std::size_t ImplicitSystem<S>::bytes() const {
  std::size_t sum = chunks_.bytes() + begin_.bytes() + held_.bytes() + projector_.bytes() +
                    exact_projector_.bytes() + v_.bytes() + residual_.bytes() + partial_.bytes() +
                    v_star_.bytes();
  for (const AlignedArray<S>* field : {&z_last_, &z_, &w_last_, &w_, &d_}) sum += field->bytes();
  for (const Thread& t : thread_) sum += t.numbers.bytes() + t.field.bytes() + t.cells.bytes();
  return sum;
}

template class ImplicitSystem<float>;
template class ImplicitSystem<double>;
template void ImplicitSystem<float>::apply<float>();
template void ImplicitSystem<float>::apply<double>();
template void ImplicitSystem<double>::apply<double>();
template const float* ImplicitSystem<float>::applied<float>(std::size_t, Thread&) const;
template const double* ImplicitSystem<float>::applied<double>(std::size_t, Thread&) const;
template const double* ImplicitSystem<double>::applied<double>(std::size_t, Thread&) const;

}  // namespace firn::optimized
