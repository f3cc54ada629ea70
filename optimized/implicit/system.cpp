#include "optimized/implicit/system.hpp"

#include <algorithm>
#include <cmath>
#include <omp.h>
#include <stdexcept>

namespace firn::optimized {

namespace {

/// Where a node block has a tile's node; −1 if it does not.
int node_of(const Region& region, const std::array<int, 3>& tile_node) {
  int node = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int k = tile_node[axis] - region.tile[axis];
    if (k < 0 || k >= region.size[axis]) return -1;
    node = 4 * node + region.node[axis] + k;
  }
  return node;
}

}  // namespace

template <class S>
void ImplicitSystem<S>::release(std::size_t node_blocks) {
  motion_.require(node_blocks, node_blocks / 8);
  held_.require(node_blocks, node_blocks / 8);
  std::fill_n(held_.data(), node_blocks, nullptr);
  projectors_in_use_ = 0;
}

template <class S>
double* ImplicitSystem<S>::take_projector() {
  constexpr std::size_t size =
      matrix_size + (sizeof(S) == sizeof(double) ? 0 : matrix_size * sizeof(S) / sizeof(double));
  double* projector = nullptr;
#pragma omp critical(firn_projectors)
  {
    if (projectors_in_use_ == projectors_.size())
      projectors_.push_back(allocate_aligned<double>(size));
    projector = projectors_[projectors_in_use_++].get();
  }
  return projector;
}

template <class S>
void ImplicitSystem<S>::set_free_directions(std::size_t n, int k, const Mat3& P) {
  const auto set = [&](int node, const Mat3& A) {
    const double entries[6] = {A(0, 0), A(0, 1), A(0, 2), A(1, 1), A(1, 2), A(2, 2)};
    for (int e = 0; e < 6; ++e) {
      const int i = e * nodes_per_block + node;
      held_[n][i] = entries[e];
      if constexpr (sizeof(S) < sizeof(double))
        reinterpret_cast<S*>(held_[n] + matrix_size)[i] = static_cast<S>(entries[e]);
    }
  };
  if (held_[n] == nullptr) {
    held_[n] = take_projector();
    for (int i = 0; i < nodes_per_block; ++i) set(i, Mat3::Identity());
  }
  set(k, P);
}

template <class S>
Mat3 ImplicitSystem<S>::free_directions(std::size_t n, int k) const {
  const double* const projector = exact_projector(n);
  if (projector == nullptr) return Mat3::Identity();
  const auto at = [&](int e) { return projector[e * nodes_per_block + k]; };
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
void ImplicitSystem<S>::assemble(ParticleStore<S>& particles, NodeStore<S>& nodes,
                                 const StepConstants<S>& step, double factor,
                                 std::vector<ThreadMemory<S>>& memory) {
  particles_ = &particles;
  nodes_ = &nodes;
  memory_ = &memory;
  slots_ = step.slots;
  factor_ = factor;
  const auto fits = [&](int gathered_size, std::size_t number) {
    return static_cast<std::size_t>(gathered_size) * number <= nodes.gathered_bytes();
  };
  if (!fits(hessian_in_float_.gathered_size, sizeof(float)) ||
      !fits(hessian_in_double_.gathered_size, sizeof(double)))
    throw std::logic_error("a vector field does not fit into the gathered fields' memory");
  partial_.require(nodes.size(), nodes.size() / 8);
  sums_.resize(static_cast<std::size_t>(threads_));
  lay_out_vectors();
  factor_particles(step);
  make_room_for_records();
}

/// [v | z | the operator's tiles in S | z_last, w_last, w, d]. An application in double, to
/// find a residual, may take the place of the last four for its tiles: they live between two
/// residuals only.
template <class S>
void ImplicitSystem<S>::lay_out_vectors() {
  const std::size_t n = node_blocks() * field_size, active = particles_->active().size();
  const auto tiles = [&](int tile_size, std::size_t number) {
    return (active * static_cast<std::size_t>(tile_size) * number + cache_line - 1) / cache_line *
           cache_line;
  };
  const std::size_t in_S = tiles(hessian<S>().tile_size, sizeof(S));
  const std::size_t in_double = tiles(hessian_in_double_.tile_size, sizeof(double));
  const std::size_t front = n * (sizeof(double) + sizeof(S));
  std::byte* const memory =
      nodes_->tile_memory(front + std::max(in_S + 4 * n * sizeof(S), in_double));
  v_ = reinterpret_cast<double*>(memory);
  z_ = reinterpret_cast<S*>(v_ + n);
  tiles_ = memory + front;
  S* last = reinterpret_cast<S*>(tiles_ + in_S);
  for (S** field : {&z_last_, &w_last_, &w_, &d_}) *field = last, last += n;
}

template <class S>
void ImplicitSystem<S>::factor_particles(const StepConstants<S>& step) {
  const std::vector<int>& active = particles_->active();
  constexpr std::size_t lanes = chunk_lanes<float>;  // of the longest vector
  first_.resize(active.size() + 1);
  if constexpr (sizeof(S) > sizeof(float)) defects_.resize(active.size());
  first_[0] = 0;
  for (std::size_t a = 0; a < active.size(); ++a) {
    const auto count = static_cast<std::size_t>(particles_->block(active[a]).count);
    first_[a + 1] = first_[a] + (count + lanes - 1) / lanes * lanes * hessian_slots;
  }
  // Whichever blocks the particles are in: lanes are left over in each block's last chunk.
  factors_.require((particles_->size() + active.size() * (lanes - 1)) * hessian_slots,
                   active.size() / 8 * lanes * hessian_slots);
  begin_.require(active.size() * (nodes_per_block + 1), active.size() * nodes_per_block / 8);
  const int n = static_cast<int>(active.size());
#pragma omp parallel for num_threads(threads_) schedule(dynamic, blocks_per_turn(n, threads_))
  for (int i = 0; i < n; ++i) {
    const auto a = static_cast<std::size_t>(i);
    ThreadMemory<S>& memory = (*memory_)[static_cast<std::size_t>(omp_get_thread_num())];
    Block<S>& block = particles_->block(active[a]);
    // A sort keeps the order within a cell, and with it every sum of stages 1 to 5.
    particles_->sort(block, memory.sorting);
    setup_.factors(particles_->view(block), step, memory.cells.data(),
                   begin_.data() + a * (nodes_per_block + 1), factors_.data() + first_[a]);
    if constexpr (sizeof(S) > sizeof(float)) defects_[a].anchor = anchor(block);
  }
}

template <class S>
std::array<int, 3> ImplicitSystem<S>::anchor(const Block<S>& block) const {
  int heaviest = 0;
  for (int i = 1; i < block.count; ++i)
    if (particles_->value(block, i, slot_m) > particles_->value(block, heaviest, slot_m))
      heaviest = i;
  std::array<int, 3> node;
  for (int axis = 0; axis < 3; ++axis) {
    const double x = particles_->value(block, heaviest, slot_x + axis);
    node[static_cast<std::size_t>(axis)] = 1 + static_cast<int>(x + 0.5);
  }
  return node;
}

/// Each thread's workspace of the explicit step serves the operator, in double as in S. The
/// records of one slab fit most often.
template <class S>
void ImplicitSystem<S>::make_room_for_records() {
  std::int32_t largest = 0;
  for (std::size_t a = 0; a < particles_->active().size(); ++a) {
    const std::int32_t* begin = begin_.data() + a * (nodes_per_block + 1);
    for (int x = 0; x < block_cells; ++x, begin += 16)
      largest = std::max(largest, begin[16] - begin[0]);
  }
  // Slabs begin and end inside of vectors; places are counted from whole cache lines.
  largest_slab_ = (largest / page_particles + 3) * page_particles;
  const auto records =
      static_cast<std::size_t>(largest_slab_) * (hessian_weights + hessian_record_size);
  const std::size_t in_double =
      vector_moments_size + vector_local_size + vector_coefficients_size + records;
  const std::size_t n = in_double * (sizeof(double) / sizeof(S));
  for (ThreadMemory<S>& memory : *memory_) memory.require_numbers(n, n / 8);
}

template <class S>
template <class T>
HessianScratch<T> ImplicitSystem<S>::scratch() const {
  HessianScratch<T> s;
  s.moments = reinterpret_cast<T*>(
      (*memory_)[static_cast<std::size_t>(omp_get_thread_num())].numbers.data());
  s.local = s.moments + vector_moments_size;
  s.coefficients = s.local + vector_local_size;
  s.weights = s.coefficients + vector_coefficients_size;
  s.records = s.weights + static_cast<std::ptrdiff_t>(largest_slab_) * hessian_weights;
  return s;
}

template <class S>
HessianBlock<S> ImplicitSystem<S>::particles_of(std::size_t active) const {
  return {particles_->view(particles_->block(particles_->active()[active])), slots_,
          factors_.data() + first_[active], begin_.data() + active * (nodes_per_block + 1)};
}

template <class S>
template <class T>
void ImplicitSystem<S>::apply() {
  const HessianKernels<T, S>& kernels = hessian<T>();
  const int n = static_cast<int>(particles_->active().size());
#pragma omp parallel for num_threads(threads_) schedule(dynamic, blocks_per_turn(n, threads_))
  for (int i = 0; i < n; ++i) {
    const auto a = static_cast<std::size_t>(i);
    const HessianScratch<T> work = scratch<T>();
    nodes_->load_surroundings(
        a, kernels, [&](std::size_t n) { return gathered<T>(n); }, work.local);
    kernels.difference(work);
    kernels.apply(particles_of(a), work, tile<T>(a));
    if constexpr (sizeof(T) < sizeof(S)) kernels.total(tile<T>(a), defects_[a].total);
  }
}

/// Inner forces add up to 0, exactly or to the roundoff of the type in which they are scattered; if
/// that is narrower than the fields', momentum would drift. What a tile's forces lack is given to
/// one of its nodes. All particles of a block share nodes, so that this is one of their own body's
/// (but for particles less than some 1e-6 h from a plane of nodes, whose outer weights vanish).
template <class S>
template <class T>
const FieldType<T, S>* ImplicitSystem<S>::applied(std::size_t n, Sums& thread) const {
  using Field = FieldType<T, S>;
  const HessianKernels<T, S>& kernels = hessian<T>();
  Field* const sums = reinterpret_cast<Field*>(thread.interleaved);
  Field* const planar = reinterpret_cast<Field*>(thread.planar);
  std::fill_n(sums, kernels.sums_size, Field(0));
  const NodeBlock& block = nodes_->block(n);
  const Share* share = nodes_->shares(block);
  for (int k = 0; k < block.share_count; ++k)
    kernels.add_tile(tile<T>(static_cast<std::size_t>(share[k].tile_number)), share[k].region,
                     sums);
  kernels.planar(sums, planar);
  if constexpr (sizeof(T) < sizeof(S)) {
    for (int k = 0; k < block.share_count; ++k) {
      const Defect& defect = defects_[static_cast<std::size_t>(share[k].tile_number)];
      const int node = node_of(share[k].region, defect.anchor);
      if (node < 0) continue;
      for (int axis = 0; axis < 3; ++axis)
        planar[axis * nodes_per_block + node] -= defect.total[axis];
    }
  }
  return planar;
}

template <class S>
std::size_t ImplicitSystem<S>::bytes() const {
  constexpr std::size_t projector =
      matrix_size * (sizeof(S) == sizeof(double) ? sizeof(S) : sizeof(S) + sizeof(double));
  return factors_.bytes() + first_.capacity() * sizeof(first_[0]) + begin_.bytes() +
         motion_.bytes() + held_.bytes() + projectors_.size() * projector +
         defects_.capacity() * sizeof(Defect) + sums_.size() * sizeof(Sums) + partial_.bytes() +
         v_star_.bytes();
}

template class ImplicitSystem<float>;
template class ImplicitSystem<double>;
template void ImplicitSystem<float>::apply<float>();
template void ImplicitSystem<float>::apply<double>();
template void ImplicitSystem<double>::apply<float>();
template void ImplicitSystem<double>::apply<double>();
template const float* ImplicitSystem<float>::applied<float>(std::size_t, Sums&) const;
template const double* ImplicitSystem<float>::applied<double>(std::size_t, Sums&) const;
template const double* ImplicitSystem<double>::applied<float>(std::size_t, Sums&) const;
template const double* ImplicitSystem<double>::applied<double>(std::size_t, Sums&) const;

}  // namespace firn::optimized
