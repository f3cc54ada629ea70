// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/store/particle_store.hpp"

#include <algorithm>
#include <cstdlib>
#include <hwy/cache_control.h>

#include "optimized/store/coordinate.hpp"

namespace firn::optimized {

template <class T>
BlockView<T> ParticleStore<T>::view(const Block<T>& block) const {
  return {block.pages.data(),
          static_cast<int>(block.count),
          {block.limit[0], block.limit[1], block.limit[2]}};
}

template <class T>
std::size_t ParticleStore<T>::index(const Block<T>& block, std::size_t i) const {
  return static_cast<std::size_t>(std::bit_cast<Integer<T>>(value(block, i, slot_index)));
}

template <class T>
std::int32_t ParticleStore<T>::material(const Block<T>& block, std::size_t i) const {
  if (slots_ == slots_common) return material_.empty() ? 0 : material_[index(block, i)];
  return static_cast<std::int32_t>(std::bit_cast<Integer<T>>(value(block, i, slot_material)));
}

template <class T>
double ParticleStore<T>::grid_position(const Block<T>& block, std::size_t i, int axis) const {
  const std::int32_t b = axis == 0 ? block.b.i : axis == 1 ? block.b.j : block.b.k;
  return block_cells * static_cast<double>(b) +
         Coordinate<T>::cells(number_of<T>(value(block, i, slot_x + axis)));
}

template <class T>
Mat3 ParticleStore<T>::identity_plus(const Block<T>& block, std::size_t i, std::size_t slot) const {
  Mat3 F;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      F(r, c) = (r == c ? 1.0 : 0.0) + static_cast<double>(value(block, i, slot++));
  return F;
}

template <class T>
Vec3 ParticleStore<T>::position(const Block<T>& block, std::size_t i) const {
  Vec3 x;
  for (int axis = 0; axis < 3; ++axis)
    x[axis] = lattice_.origin()[axis] + lattice_.spacing() * grid_position(block, i, axis);
  return x;
}

template <class T>
BlockNumber ParticleStore<T>::find_or_create(const NodeIndex& b) {
  const BlockNumber fresh =
      unused_.empty() ? static_cast<BlockNumber>(blocks_.size()) : unused_.back();
  const BlockNumber number = map_.find_or_insert(b, fresh);
  if (number != fresh) return number;
  if (unused_.empty())
    blocks_.emplace_back();
  else
    unused_.pop_back();
  Block<T>& block = blocks_[number];
  block.b = b;
  block.count = 0;
  const std::int32_t at[3] = {b.i, b.j, b.k};
  for (int axis = 0; axis < 3; ++axis)
    block.limit[axis] = static_cast<T>(lattice_.cells(axis, at[axis]));
  return number;
}

template <class T>
void ParticleStore<T>::reserve(Block<T>& block, std::size_t count) {
  while (block.pages.size() * page_particles < count) block.pages.push_back(pool_.take());
}

/// The page must be there.
template <class T>
void ParticleStore<T>::append(Block<T>& block, const T* values) {
  const std::size_t i = block.count++;
  for (std::size_t s = 0; s < slots_; ++s) value(block, i, s) = values[s];
}

template <class T>
void ParticleStore<T>::clear() {
  blocks_.clear(), unused_.clear(), active_.clear();
  map_.reset(64);
  pool_.reset(slots_);
}

template <class T>
void ParticleStore<T>::sort(Block<T>& block, AlignedArray<T>& scratch) const {
  constexpr std::size_t n = chunk_lanes<T>;
  constexpr std::size_t ahead = 4 * n;
  const std::size_t chunk = slots_ * n, chunks = (block.count + n - 1) / n;
  // Whole chunks, sorted; the cell of every particle; which particle comes to a place.
  scratch.require(chunks * (chunk + 2 * n));
  Arena arena(scratch.lend());
  T* const sorted = arena.take<T>(chunks * chunk);
  auto* const cell = arena.take<Integer<T>>(chunks * n);
  auto* const order = arena.take<Integer<T>>(chunks * n);
  std::int32_t begin[cells_per_block + 1] = {};
  bool in_order = true;
  for (std::size_t i = 0; i < block.count; ++i) {
    if (i % n == 0 && i + ahead < block.count)  // single lines, which nobody sees coming
      for (int axis = 0; axis < 3; ++axis) hwy::Prefetch(&value(block, i + ahead, slot_x + axis));
    int c = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto x = number_of<T>(value(block, i, slot_x + axis));
      c = block_cells * c +
          std::clamp(static_cast<int>(x / Coordinate<T>::one), 0, block_cells - 1);
    }
    cell[i] = static_cast<Integer<T>>(c);
    ++begin[c + 1];
    in_order = in_order && (i == 0 || cell[i] >= cell[i - 1]);
  }
  if (in_order) return;
  for (int c = 0; c < cells_per_block; ++c) begin[c + 1] += begin[c];
  for (std::size_t i = 0; i < block.count; ++i)
    order[begin[cell[i]]++] = static_cast<Integer<T>>(i);
  std::fill(order + block.count, order + chunks * n, order[0]);  // to fill the last chunk
  for (std::size_t c = 0; c < chunks; ++c) {
    const T* from[n];
    for (std::size_t l = 0; l < n; ++l)
      from[l] = &value(block, static_cast<std::size_t>(order[c * n + l]), 0);
    T* to = sorted + c * chunk;
    for (std::size_t s = 0; s < chunk; s += n, to += n)
      for (std::size_t l = 0; l < n; ++l) to[l] = from[l][s];
  }
  for (std::size_t c = 0; c < chunks; ++c) {
    const std::size_t lanes = std::min(n, block.count - c * n);  // spare ones keep what they hold
    T* to = &value(block, c * n, 0);
    const T* from = sorted + c * chunk;
    if (lanes == n)
      std::copy(from, from + chunk, to);
    else
      for (std::size_t s = 0; s < slots_; ++s)
        std::copy(from + s * n, from + s * n + lanes, to + s * n);
  }
}

template <class T>
int ParticleStore<T>::take_out(Block<T>& block, std::span<const std::int32_t> places) const {
  block.leavers.clear();
  block.luggage.clear();
  int lost = nobody;
  for (const std::int32_t i : places) {
    std::int32_t b[3] = {block.b.i, block.b.j, block.b.k};
    for (int axis = 0; axis < 3; ++axis) {
      T& slot = value(block, i, slot_x + axis);
      auto x = number_of<T>(slot);
      lattice_.settle(axis, b[axis], x, Coordinate<T>::one);
      slot = std::bit_cast<T>(x);
      if (std::abs(b[axis]) >= reachable_blocks && lost == nobody) lost = i;
    }
    block.leavers.push_back({b[0], b[1], b[2]});
    for (std::size_t s = 0; s < slots_; ++s) block.luggage.push_back(value(block, i, s));
  }
  // If the step has failed nobody moves, so that places keep their meaning.
  if (lost != nobody) return lost;
  for (std::size_t k = places.size(); k-- > 0;) {
    const std::size_t hole = places[k], last = --block.count;
    if (hole == last) continue;
    for (std::size_t s = 0; s < slots_; ++s) value(block, hole, s) = value(block, last, s);
  }
  return nobody;
}

template <class T>
void ParticleStore<T>::put_in(int threads) {
  // Who goes where, in the order of the blocks that they left: neither the number
  // of threads nor the numbers of the blocks has any influence on a block's order.
  const std::size_t known = active_.size();
  bool changed = false;
  for (std::size_t a = 0; a < known; ++a) {
    const BlockNumber from = active_[a];
    if (block(from).count == 0) changed = true;
    for (std::uint32_t k = 0; k < block(from).leavers.size(); ++k) {
      Block<T>& target = block(find_or_create(block(from).leavers[k]));
      target.arrivals.push_back({from, k});
      reserve(target, target.count + target.arrivals.size());
    }
  }
  const std::size_t n = blocks_.size();
#pragma omp parallel for num_threads(threads) schedule(static) reduction(|| : changed)
  for (std::size_t to = 0; to < n; ++to) {
    Block<T>& target = blocks_[to];
    if (target.arrivals.empty()) continue;
    if (target.count == 0) changed = true;
    for (const Arrival& a : target.arrivals)
      append(target, block(a.from).luggage.data() + a.place * slots_);
    target.arrivals.clear();
  }
  for (std::size_t a = 0; a < known; ++a) block(active_[a]).leavers.clear();
  if (changed) refresh_active();
  for (const BlockNumber number : active_) largest_ = std::max(largest_, block(number).count);
}

template <class T>
void ParticleStore<T>::refresh_active() {
  ++generation_;
  active_.clear();
  largest_ = 0;
  unused_.clear();
  map_.reset(blocks_.size());
  for (std::size_t i = blocks_.size(); i-- > 0;) {
    Block<T>& block = blocks_[i];
    if (block.count == 0) {
      for (T* page : block.pages) pool_.give_back(page);
      block.pages.clear();
      unused_.push_back(static_cast<BlockNumber>(i));
      continue;
    }
    map_.find_or_insert(block.b, static_cast<BlockNumber>(i));
    largest_ = std::max(largest_, block.count);
    active_.push_back(static_cast<BlockNumber>(i));
  }
  std::sort(active_.begin(), active_.end(),
            [this](BlockNumber a, BlockNumber b) { return block(a).b < block(b).b; });
}

template <class T>
std::size_t ParticleStore<T>::bytes() const {
  std::size_t sum = pool_.bytes() + id_.capacity() * sizeof(std::int64_t) +
                    material_.capacity() * sizeof(std::int32_t);
  for (const Block<T>& block : blocks_)
    sum += sizeof block + block.pages.capacity() * sizeof(T*) +
           block.leavers.capacity() * sizeof(NodeIndex) + block.luggage.capacity() * sizeof(T) +
           block.arrivals.capacity() * sizeof(Arrival);
  return sum;
}

template class ParticleStore<float>;
template class ParticleStore<double>;

}  // namespace firn::optimized
