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
  int from, place;
};

template <class T>
struct Block {
  NodeIndex b;      ///< holds cells 4b … 4b+3
  int count = 0;    ///< particles; 0 = the entry is not in use
  T limit[3] = {};  ///< its width in cells along each axis
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

  int slots() const { return slots_; }
  std::size_t size() const { return size_; }
  const Lattice& lattice() const { return lattice_; }

  /// Numbers of the blocks that hold particles, sorted by position.
  const std::vector<int>& active() const { return active_; }
  Block<T>& block(int number) { return blocks_[static_cast<std::size_t>(number)]; }
  const Block<T>& block(int number) const { return blocks_[static_cast<std::size_t>(number)]; }
  int largest_block() const { return largest_; }
  BlockView<T> view(const Block<T>& block) const;

  /// Quantity `slot` of particle i of a block.
  T& value(const Block<T>& block, int i, int slot) const {
    constexpr unsigned n = chunk_lanes<T>;
    const auto u = static_cast<unsigned>(i);  // so that / and % are a shift and a mask
    const unsigned chunk = u % page_particles / n * static_cast<unsigned>(slots_);
    return block.pages[u / page_particles][(chunk + static_cast<unsigned>(slot)) * n + u % n];
  }
  std::size_t index(const Block<T>& block, int i) const;
  std::int32_t material(const Block<T>& block, int i) const;

  /// Position in units of h relative to node 0, and in the world.
  double grid_position(const Block<T>& block, int i, int axis) const;
  Vec3 position(const Block<T>& block, int i) const;

  /// Sorts a block's particles by cell; keeps the order within a cell.
  void sort(Block<T>& block, AlignedArray<T>& scratch) const;

  /// Takes `n` particles (ascending places) out of a block; the holes are filled
  /// from its tail. May run for several blocks at once. Returns the first that
  /// would leave the domain, −1 if none.
  int take_out(Block<T>& block, const std::int32_t* places, int n) const;

  /// Puts everybody who was taken out where he belongs. True if the set of blocks
  /// with particles changed.
  bool put_in(int threads);

  std::size_t bytes() const;

 private:
  int find_or_create(const NodeIndex& b);
  void clear();
  void reserve(Block<T>& block, int count);
  void append(Block<T>& block, const T* values);
  std::size_t restart_row() const;
  void refresh_active();

  Lattice lattice_;
  int slots_ = slots_common;
  std::size_t size_ = 0;
  int largest_ = 0;
  std::vector<Block<T>> blocks_;
  std::vector<int> unused_;
  std::vector<int> active_;
  BlockMap map_;
  PagePool<T> pool_;
  std::vector<std::int64_t> id_;  ///< in the caller's order
  std::vector<std::int32_t> material_;
};

extern template class ParticleStore<float>;
extern template class ParticleStore<double>;

}  // namespace firn::optimized
