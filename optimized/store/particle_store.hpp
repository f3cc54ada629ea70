// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The particles in blocks of 4×4×4 cells, and how they move between blocks.

#include <cstdint>
#include <span>
#include <vector>

#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "optimized/store/block_map.hpp"
#include "optimized/store/lattice.hpp"
#include "optimized/store/memory.hpp"

namespace firn::optimized {

/// A particle that comes into a block: the `place`th of those that left block `from`.
struct Arrival {
  BlockNumber from;
  std::uint32_t place;
};

template <class T>
struct Block {
  NodeIndex b;            ///< holds cells 4b … 4b+3
  std::size_t count = 0;  ///< particles; 0 = the entry is not in use
  T limit[3] = {};        ///< its width in cells along each axis
  std::vector<T*> pages;
  std::vector<NodeIndex> leavers;  ///< where those who left go
  std::vector<T> luggage;          ///< their values, `slots` each
  std::vector<Arrival> arrivals;
};

template <class T>
class ParticleStore {
 public:
  /// Particles into blocks; within a block by cell, within a cell in the caller's
  /// order. Throws SimulationError for a position that is not finite or lies
  /// outside ±block_limit.
  /// `with_material`: keeps the material of each particle also where there is one only.
  void load(const Scene& scene, const State& state, bool with_material);
  void store(Particles& particles) const;

  /// Everything that State does not say: block, rank in it and the exact values.
  std::size_t restart_size() const;
  void store_restart(std::span<std::byte> bytes) const;
  void load_restart(std::span<const std::byte> bytes);

  std::size_t slots() const { return slots_; }
  std::size_t size() const { return size_; }
  const Lattice& lattice() const { return lattice_; }

  /// Numbers of the blocks that hold particles, sorted by position.
  const std::vector<BlockNumber>& active() const { return active_; }
  Block<T>& block(BlockNumber number) { return blocks_[number]; }
  const Block<T>& block(BlockNumber number) const { return blocks_[number]; }
  /// The block in place `a` of active().
  Block<T>& active_block(std::size_t a) { return blocks_[active_[a]]; }
  const Block<T>& active_block(std::size_t a) const { return blocks_[active_[a]]; }
  std::size_t largest_block() const { return largest_; }
  /// Another number whenever active() has changed.
  std::uint64_t generation() const { return generation_; }
  BlockView<T> view(const Block<T>& block) const;

  /// Quantity `slot` of particle i of a block.
  T& value(const Block<T>& block, std::size_t i, std::size_t slot) const {
    constexpr std::size_t n = chunk_lanes<T>;
    const std::size_t chunk = i % page_particles / n * slots_;
    return block.pages[i / page_particles][(chunk + slot) * n + i % n];
  }
  /// The vector in slots `slot` … `slot` + 2.
  Vec3 vector(const Block<T>& block, std::size_t i, std::size_t slot) const {
    return Vec3(static_cast<double>(value(block, i, slot)),
                static_cast<double>(value(block, i, slot + 1)),
                static_cast<double>(value(block, i, slot + 2)));
  }
  /// I plus what slots `slot` … `slot` + 8 hold, row by row.
  Mat3 identity_plus(const Block<T>& block, std::size_t i, std::size_t slot) const;
  /// Place in the caller's order.
  std::size_t index(const Block<T>& block, std::size_t i) const;
  std::int32_t material(const Block<T>& block, std::size_t i) const;

  /// Position in units of h relative to node 0, and in the world.
  double grid_position(const Block<T>& block, std::size_t i, int axis) const;
  Vec3 position(const Block<T>& block, std::size_t i) const;

  /// Sorts a block's particles by cell; keeps the order within a cell.
  void sort(Block<T>& block, AlignedArray<T>& scratch) const;

  /// Takes the particles in these places (ascending) out of a block; the holes are filled
  /// from its tail. May run for several blocks at once. Returns the place of the first that
  /// would leave the domain, `nobody` if none; then nobody moves.
  static constexpr int nobody = -1;
  int take_out(Block<T>& block, std::span<const std::int32_t> places) const;

  /// Puts every particle that was taken out where it belongs.
  void put_in(int threads);

  std::size_t bytes() const;

 private:
  BlockNumber find_or_create(const NodeIndex& b);
  void clear();
  void reserve(Block<T>& block, std::size_t count);
  void append(Block<T>& block, const T* values);
  void refresh_active();

  Lattice lattice_;
  std::size_t slots_ = slots_common;
  std::size_t size_ = 0, largest_ = 0;
  std::uint64_t generation_ = 0;
  std::vector<Block<T>> blocks_;
  std::vector<BlockNumber> unused_, active_;
  BlockMap map_;
  PagePool<T> pool_;
  std::vector<std::int64_t> id_;  ///< in the caller's order
  std::vector<std::int32_t> material_;
};

extern template class ParticleStore<float>;
extern template class ParticleStore<double>;

}  // namespace firn::optimized
