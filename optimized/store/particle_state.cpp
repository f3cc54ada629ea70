// SPDX-License-Identifier: BSD-3-Clause
/// Particles from and to a State, and what a restart needs beyond it.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>

#include "firn/error.hpp"
#include "optimized/store/coordinate.hpp"
#include "optimized/store/particle_store.hpp"

namespace firn::optimized {

namespace {

[[noreturn]] void fail(Stage stage, std::size_t p, const std::string& what) {
  throw SimulationError(stage, SimulationError::Subject::particle, static_cast<std::int64_t>(p),
                        what);
}

/// A row of restart data: block (3) and rank in it; then all values.
using RestartPlace = std::array<std::int32_t, 4>;

template <class T>
std::size_t bytes_of_row(const ParticleStore<T>& particles) {
  return sizeof(RestartPlace) + particles.slots() * sizeof(T);
}

}  // namespace

template <class T>
void ParticleStore<T>::load(const Scene& scene, const State& state, bool with_material) {
  const Particles& p = state.particles;
  lattice_ = Lattice(scene.grid);
  with_material = with_material || scene.materials.size() > 1;
  slots_ = with_material ? slot_material + 1 : slots_common;
  size_ = p.size();
  clear();
  id_ = p.id;
  material_.clear();
  if (with_material) material_ = p.material;

  std::vector<T> q(slots_);
  for (std::size_t i = 0; i < p.size(); ++i) {
    std::int32_t b[3];
    const Vec3 x_p = scene.wrap(p.x[i]);
    for (int axis = 0; axis < 3; ++axis) {
      const double X = (x_p[axis] - scene.grid.origin[axis]) / scene.grid.spacing;
      if (!(std::abs(X) < static_cast<double>(block_cells) * reachable_blocks))
        fail(state.next, i, "position is not finite or too far from the origin of the grid");
      double x;
      lattice_.locate(axis, X, b[axis], x);
      auto n = Coordinate<T>::from(x);
      lattice_.settle(axis, b[axis], n, Coordinate<T>::one);
      q[slot_x + axis] = std::bit_cast<T>(n);
      q[slot_v + axis] = static_cast<T>(p.v[i][axis]);
    }
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        const double identity = r == c ? 1 : 0;
        q[slot_E_E + 3 * r + c] = static_cast<T>(p.F_E[i](r, c) - identity);
        q[slot_E_P + 3 * r + c] = static_cast<T>(p.F_P[i](r, c) - identity);
      }
    std::fill_n(&q[slot_tau], 6, T(0));
    q[slot_m] = static_cast<T>(p.m[i]);
    q[slot_V_0] = static_cast<T>(p.V_0[i]);
    q[slot_stiffness] = 0;
    q[slot_index] = std::bit_cast<T>(static_cast<Integer<T>>(i));
    if (with_material) q[slot_material] = std::bit_cast<T>(static_cast<Integer<T>>(p.material[i]));
    Block<T>& block = this->block(find_or_create({b[0], b[1], b[2]}));
    reserve(block, block.count + 1);
    append(block, q.data());
  }
  refresh_active();
  AlignedArray<T> scratch;
  for (const BlockNumber number : active_) sort(block(number), scratch);
}

template <class T>
void ParticleStore<T>::store(Particles& p) const {
  p.resize(size_);
  p.id = id_;
  if (!material_.empty())
    p.material = material_;
  else
    std::fill(p.material.begin(), p.material.end(), 0);
  for (const BlockNumber number : active_) {
    const Block<T>& block = this->block(number);
    for (std::size_t i = 0; i < block.count; ++i) {
      const std::size_t to = index(block, i);
      p.x[to] = position(block, i);
      for (int axis = 0; axis < 3; ++axis) {
        // x + h(4b + …) may round up to the end of the period.
        if (lattice_.period(axis) > 0 &&
            p.x[to][axis] >= lattice_.origin()[axis] + lattice_.spacing() * lattice_.period(axis))
          p.x[to][axis] = lattice_.origin()[axis];
      }
      p.v[to] = vector(block, i, slot_v);
      p.F_E[to] = identity_plus(block, i, slot_E_E);
      p.F_P[to] = identity_plus(block, i, slot_E_P);
      p.m[to] = static_cast<double>(value(block, i, slot_m));
      p.V_0[to] = static_cast<double>(value(block, i, slot_V_0));
    }
  }
}

template <class T>
std::size_t ParticleStore<T>::restart_size() const {
  return size_ * bytes_of_row(*this);
}

template <class T>
void ParticleStore<T>::store_restart(std::span<std::byte> bytes) const {
  for (const BlockNumber number : active_) {
    const Block<T>& block = this->block(number);
    for (std::size_t i = 0; i < block.count; ++i) {
      std::byte* to = bytes.data() + index(block, i) * bytes_of_row(*this);
      const RestartPlace place = {block.b.i, block.b.j, block.b.k, static_cast<std::int32_t>(i)};
      std::memcpy(to, place.data(), sizeof place);
      to += sizeof place;
      for (std::size_t s = 0; s < slots_; ++s, to += sizeof(T))
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
    RestartPlace place;
    std::memcpy(place.data(), bytes.data() + p * bytes_of_row(*this), sizeof place);
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
    reserve(block, std::max(static_cast<std::size_t>(rank) + 1, block.count));
    const std::byte* from = bytes.data() + p * bytes_of_row(*this) + sizeof(RestartPlace);
    for (std::size_t s = 0; s < slots_; ++s, from += sizeof(T))
      std::memcpy(&value(block, rank, s), from, sizeof(T));
  }
  refresh_active();
}

template void ParticleStore<float>::load(const Scene&, const State&, bool);
template void ParticleStore<float>::store(Particles&) const;
template std::size_t ParticleStore<float>::restart_size() const;
template void ParticleStore<float>::store_restart(std::span<std::byte>) const;
template void ParticleStore<float>::load_restart(std::span<const std::byte>);
template void ParticleStore<double>::load(const Scene&, const State&, bool);
template void ParticleStore<double>::store(Particles&) const;
template std::size_t ParticleStore<double>::restart_size() const;
template void ParticleStore<double>::store_restart(std::span<std::byte>) const;
template void ParticleStore<double>::load_restart(std::span<const std::byte>);

}  // namespace firn::optimized
