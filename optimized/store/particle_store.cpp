#include "optimized/store/particle_store.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <hwy/cache_control.h>

#include "firn/error.hpp"

namespace firn::optimized {

namespace {

/// Positions are int32 in float (layout.hpp), plain numbers in double.
template <class T>
struct Coordinate;
template <>
struct Coordinate<float> {
  using Number = std::int32_t;
  static constexpr Number one = fixed_one;
  static Number from(double x) { return static_cast<Number>(std::lround(x * fixed_one)); }
  static double cells(Number x) { return static_cast<double>(x) / fixed_one; }
};
template <>
struct Coordinate<double> {
  using Number = double;
  static constexpr Number one = 1;
  static Number from(double x) { return x; }
  static double cells(Number x) { return x; }
};

template <class T>
typename Coordinate<T>::Number number_of(T value) {
  return std::bit_cast<typename Coordinate<T>::Number>(value);
}

[[noreturn]] void fail(Stage stage, std::size_t p, const std::string& what) {
  throw SimulationError(stage, SimulationError::Subject::particle, static_cast<std::int64_t>(p),
                        what);
}

}  // namespace

template <class T>
BlockView<T> ParticleStore<T>::view(const Block<T>& block) const {
  return {block.pages.data(), block.count, {block.limit[0], block.limit[1], block.limit[2]}};
}

template <class T>
std::size_t ParticleStore<T>::index(const Block<T>& block, int i) const {
  return static_cast<std::size_t>(std::bit_cast<Integer<T>>(value(block, i, slot_index)));
}

template <class T>
std::int32_t ParticleStore<T>::material(const Block<T>& block, int i) const {
  if (slots_ == slots_common) return material_.empty() ? 0 : material_[index(block, i)];
  return static_cast<std::int32_t>(std::bit_cast<Integer<T>>(value(block, i, slot_material)));
}

template <class T>
double ParticleStore<T>::grid_position(const Block<T>& block, int i, int axis) const {
  const std::int32_t b = axis == 0 ? block.b.i : axis == 1 ? block.b.j : block.b.k;
  return block_cells * static_cast<double>(b) +
         Coordinate<T>::cells(number_of<T>(value(block, i, slot_x + axis)));
}

template <class T>
Vec3 ParticleStore<T>::position(const Block<T>& block, int i) const {
  Vec3 x;
  for (int axis = 0; axis < 3; ++axis)
    x[axis] = lattice_.origin()[axis] + lattice_.spacing() * grid_position(block, i, axis);
  return x;
}

template <class T>
int ParticleStore<T>::find_or_create(const NodeIndex& b) {
  const int fresh = unused_.empty() ? static_cast<int>(blocks_.size()) : unused_.back();
  const int number = map_.find_or_insert(b, fresh);
  if (number != fresh) return number;
  if (unused_.empty())
    blocks_.emplace_back();
  else
    unused_.pop_back();
  Block<T>& block = blocks_[static_cast<std::size_t>(number)];
  block.b = b;
  block.count = 0;
  const std::int32_t at[3] = {b.i, b.j, b.k};
  for (int axis = 0; axis < 3; ++axis)
    block.limit[axis] = static_cast<T>(lattice_.cells(axis, at[axis]));
  return number;
}

template <class T>
void ParticleStore<T>::reserve(Block<T>& block, int count) {
  while (static_cast<int>(block.pages.size()) * page_particles < count)
    block.pages.push_back(pool_.take());
}

/// The page must be there.
template <class T>
void ParticleStore<T>::append(Block<T>& block, const T* values) {
  const int i = block.count++;
  for (int s = 0; s < slots_; ++s) value(block, i, s) = values[s];
}

template <class T>
void ParticleStore<T>::clear() {
  blocks_.clear(), unused_.clear(), active_.clear();
  map_.reset(64);
  pool_.reset(slots_);
}

template <class T>
void ParticleStore<T>::load(const Scene& scene, const State& state, bool with_material) {
  const Particles& p = state.particles;
  lattice_ = Lattice(scene.grid);
  with_material = with_material || scene.materials.size() > 1;
  slots_ = slots_common + (with_material ? 1 : 0);
  size_ = p.size();
  clear();
  id_ = p.id;
  material_.clear();
  if (with_material) material_ = p.material;

  std::vector<T> q(static_cast<std::size_t>(slots_));
  for (std::size_t i = 0; i < p.size(); ++i) {
    std::int32_t b[3];
    const Vec3 x_p = scene.wrap(p.x[i]);
    for (int axis = 0; axis < 3; ++axis) {
      const double X = (x_p[axis] - scene.grid.origin[axis]) / scene.grid.spacing;
      if (!(std::abs(X) < static_cast<double>(block_cells) * (block_limit - 4)))
        fail(state.next, i, "position is not finite or too far from the origin of the grid");
      double x;
      lattice_.locate(axis, X, b[axis], x);
      auto n = Coordinate<T>::from(x);
      lattice_.settle(axis, b[axis], n, Coordinate<T>::one);
      q[static_cast<std::size_t>(slot_x + axis)] = std::bit_cast<T>(n);
      q[static_cast<std::size_t>(slot_v + axis)] = static_cast<T>(p.v[i][axis]);
    }
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        const double identity = r == c ? 1 : 0;
        q[static_cast<std::size_t>(slot_E_E + 3 * r + c)] =
            static_cast<T>(p.F_E[i](r, c) - identity);
        q[static_cast<std::size_t>(slot_E_P + 3 * r + c)] =
            static_cast<T>(p.F_P[i](r, c) - identity);
      }
    for (int k = 0; k < 6; ++k) q[static_cast<std::size_t>(slot_tau + k)] = 0;
    q[slot_m] = static_cast<T>(p.m[i]);
    q[slot_V_0] = static_cast<T>(p.V_0[i]);
    q[slot_stiffness] = 0;
    q[slot_index] = std::bit_cast<T>(static_cast<Integer<T>>(i));
    if (slots_ > slots_common)
      q[slot_material] = std::bit_cast<T>(static_cast<Integer<T>>(p.material[i]));
    Block<T>& block = blocks_[static_cast<std::size_t>(find_or_create({b[0], b[1], b[2]}))];
    reserve(block, block.count + 1);
    append(block, q.data());
  }
  refresh_active();
  AlignedArray<T> scratch;
  for (const int number : active_) sort(block(number), scratch);
}

template <class T>
void ParticleStore<T>::store(Particles& p) const {
  p.resize(size_);
  p.id = id_;
  if (!material_.empty())
    p.material = material_;
  else
    std::fill(p.material.begin(), p.material.end(), 0);
  for (const int number : active_) {
    const Block<T>& block = this->block(number);
    for (int i = 0; i < block.count; ++i) {
      const std::size_t to = index(block, i);
      p.x[to] = position(block, i);
      for (int axis = 0; axis < 3; ++axis) {
        // x + h(4b + …) may round up to the end of the period.
        if (lattice_.period(axis) > 0 &&
            p.x[to][axis] >= lattice_.origin()[axis] + lattice_.spacing() * lattice_.period(axis))
          p.x[to][axis] = lattice_.origin()[axis];
        p.v[to][axis] = static_cast<double>(value(block, i, slot_v + axis));
      }
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
          const double identity = r == c ? 1 : 0;
          p.F_E[to](r, c) = identity + static_cast<double>(value(block, i, slot_E_E + 3 * r + c));
          p.F_P[to](r, c) = identity + static_cast<double>(value(block, i, slot_E_P + 3 * r + c));
        }
      p.m[to] = static_cast<double>(value(block, i, slot_m));
      p.V_0[to] = static_cast<double>(value(block, i, slot_V_0));
    }
  }
}

template <class T>
void ParticleStore<T>::sort(Block<T>& block, AlignedArray<T>& scratch) const {
  constexpr int n = chunk_lanes<T>;
  const int chunk = slots_ * n, chunks = (block.count + n - 1) / n;
  // Whole chunks, sorted; the cell of every particle; which particle comes to a place.
  scratch.require(static_cast<std::size_t>(chunks * (chunk + 2 * n)));
  T* const sorted = scratch.data();
  auto* const cell = reinterpret_cast<Integer<T>*>(sorted + chunks * chunk);
  auto* const order = cell + chunks * n;
  int begin[nodes_per_block + 1] = {};
  bool in_order = true;
  for (int i = 0; i < block.count; ++i) {
    if (i % n == 0 && i + 4 * n < block.count)  // single lines, which nobody sees coming
      for (int axis = 0; axis < 3; ++axis) hwy::Prefetch(&value(block, i + 4 * n, slot_x + axis));
    int c = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto x = number_of<T>(value(block, i, slot_x + axis));
      c = block_cells * c + std::clamp(static_cast<int>(x / Coordinate<T>::one), 0, 3);
    }
    cell[i] = static_cast<Integer<T>>(c);
    ++begin[c + 1];
    in_order = in_order && (i == 0 || cell[i] >= cell[i - 1]);
  }
  if (in_order) return;
  for (int c = 0; c < nodes_per_block; ++c) begin[c + 1] += begin[c];
  for (int i = 0; i < block.count; ++i) order[begin[cell[i]]++] = static_cast<Integer<T>>(i);
  for (int i = block.count; i < chunks * n; ++i) order[i] = order[0];  // to fill the last chunk
  for (int c = 0; c < chunks; ++c) {
    const T* from[n];
    for (int l = 0; l < n; ++l) from[l] = &value(block, static_cast<int>(order[c * n + l]), 0);
    T* to = sorted + c * chunk;
    for (int s = 0; s < chunk; s += n, to += n)
      for (int l = 0; l < n; ++l) to[l] = from[l][s];
  }
  for (int c = 0; c < chunks; ++c) {
    const int lanes = std::min(n, block.count - c * n);  // the spare ones keep what they hold
    T* to = &value(block, c * n, 0);
    const T* from = sorted + c * chunk;
    if (lanes == n)
      std::copy(from, from + chunk, to);
    else
      for (int s = 0; s < slots_; ++s) std::copy(from + s * n, from + s * n + lanes, to + s * n);
  }
}

template <class T>
int ParticleStore<T>::take_out(Block<T>& block, const std::int32_t* places, int n) const {
  block.leavers.clear();
  block.luggage.clear();
  int lost = -1;
  for (int k = 0; k < n; ++k) {
    const int i = places[k];
    std::int32_t b[3] = {block.b.i, block.b.j, block.b.k};
    for (int axis = 0; axis < 3; ++axis) {
      T& slot = value(block, i, slot_x + axis);
      auto x = number_of<T>(slot);
      lattice_.settle(axis, b[axis], x, Coordinate<T>::one);
      slot = std::bit_cast<T>(x);
      if (std::abs(b[axis]) >= block_limit - 4 && lost < 0) lost = i;
    }
    block.leavers.push_back({b[0], b[1], b[2]});
    for (int s = 0; s < slots_; ++s) block.luggage.push_back(value(block, i, s));
  }
  if (lost >= 0)
    return lost;  // the step has failed: nobody moves, so that places keep their meaning
  for (int k = n - 1; k >= 0; --k) {
    const int last = --block.count;
    if (places[k] == last) continue;
    for (int s = 0; s < slots_; ++s) value(block, places[k], s) = value(block, last, s);
  }
  return lost;
}

template <class T>
bool ParticleStore<T>::put_in(int threads) {
  // Who goes where, in the order of the blocks that they left: neither the number
  // of threads nor the numbers of the blocks has any influence on a block's order.
  const std::size_t known = active_.size();
  bool changed = false;
  for (std::size_t a = 0; a < known; ++a) {
    const int from = active_[a];
    if (block(from).count == 0) changed = true;
    for (int k = 0; k < static_cast<int>(block(from).leavers.size()); ++k) {
      const int to = find_or_create(block(from).leavers[static_cast<std::size_t>(k)]);
      Block<T>& target = block(to);
      target.arrivals.push_back({from, k});
      reserve(target, target.count + static_cast<int>(target.arrivals.size()));
    }
  }
  const int n = static_cast<int>(blocks_.size());
#pragma omp parallel for num_threads(threads) schedule(static) reduction(|| : changed)
  for (int to = 0; to < n; ++to) {
    Block<T>& target = block(to);
    if (target.arrivals.empty()) continue;
    if (target.count == 0) changed = true;
    for (const Arrival& a : target.arrivals)
      append(target, block(a.from).luggage.data() +
                         static_cast<std::size_t>(a.place) * static_cast<std::size_t>(slots_));
    target.arrivals.clear();
  }
  for (std::size_t a = 0; a < known; ++a) block(active_[a]).leavers.clear();
  if (changed) refresh_active();
  for (const int number : active_) largest_ = std::max(largest_, block(number).count);
  return changed;
}

template <class T>
void ParticleStore<T>::refresh_active() {
  active_.clear();
  largest_ = 0;
  unused_.clear();
  map_.reset(blocks_.size());
  for (std::size_t i = blocks_.size(); i-- > 0;) {
    Block<T>& block = blocks_[i];
    if (block.count == 0) {
      for (T* page : block.pages) pool_.give_back(page);
      block.pages.clear();
      unused_.push_back(static_cast<int>(i));
      continue;
    }
    map_.find_or_insert(block.b, static_cast<int>(i));
    largest_ = std::max(largest_, block.count);
    active_.push_back(static_cast<int>(i));
  }
  std::sort(active_.begin(), active_.end(),
            [this](int a, int b) { return block(a).b < block(b).b; });
}

/// A row: block (3), rank in it, all values.
template <class T>
std::size_t ParticleStore<T>::restart_row() const {
  return 4 * sizeof(std::int32_t) + static_cast<std::size_t>(slots_) * sizeof(T);
}

template <class T>
std::size_t ParticleStore<T>::restart_size() const {
  return size_ * restart_row();
}

template <class T>
void ParticleStore<T>::store_restart(std::span<std::byte> bytes) const {
  for (const int number : active_) {
    const Block<T>& block = this->block(number);
    for (int i = 0; i < block.count; ++i) {
      std::byte* to = bytes.data() + index(block, i) * restart_row();
      const std::int32_t place[4] = {block.b.i, block.b.j, block.b.k, i};
      std::memcpy(to, place, sizeof place);
      to += sizeof place;
      for (int s = 0; s < slots_; ++s, to += sizeof(T))
        std::memcpy(to, &value(block, i, s), sizeof(T));
    }
  }
}

template <class T>
void ParticleStore<T>::load_restart(std::span<const std::byte> bytes) {
  if (bytes.size() != restart_size())
    throw InputError("restart data", "size in bytes", std::to_string(bytes.size()),
                     std::to_string(restart_size()));
  clear();
  const auto place_of = [&](std::size_t p) {
    std::array<std::int32_t, 4> place;
    std::memcpy(place.data(), bytes.data() + p * restart_row(), sizeof place);
    return place;
  };
  for (std::size_t p = 0; p < size_; ++p) {
    const auto [i, j, k, rank] = place_of(p);
    if (std::max({std::abs(i), std::abs(j), std::abs(k)}) >= block_limit || rank < 0 ||
        static_cast<std::size_t>(rank) >= size_)
      throw InputError("restart data", "place of particle " + std::to_string(p),
                       std::to_string(rank), "0 .. " + std::to_string(size_ - 1));
    ++block(find_or_create({i, j, k})).count;
  }
  for (std::size_t p = 0; p < size_; ++p) {
    const auto [i, j, k, rank] = place_of(p);
    Block<T>& block = this->block(find_or_create({i, j, k}));
    reserve(block, std::max(rank + 1, block.count));
    const std::byte* from = bytes.data() + p * restart_row() + 4 * sizeof(std::int32_t);
    for (int s = 0; s < slots_; ++s, from += sizeof(T))
      std::memcpy(&value(block, rank, s), from, sizeof(T));
  }
  refresh_active();
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
