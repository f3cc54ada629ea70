// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The node blocks that the particles reach, who contributes to each, and who
/// gathers from where.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "firn/state.hpp"
#include "optimized/store/memory.hpp"
#include "optimized/store/particle_store.hpp"

namespace firn::optimized {

/// One tile's share in a node block: tile nodes from `tile` on are the block's
/// nodes from `node` on.
struct Share {
  BlockNumber tile_number;  ///< place among the active particle blocks
  Region region;
};

struct NodeBlock {
  NodeIndex c;  ///< holds nodes 4c−1 … 4c+2
  std::uint32_t first_share = 0, share_count = 0;
};

/// Where a particle block's 7×7×7 nodes come from.
struct Surroundings {
  std::array<BlockNumber, tile_corners> node_block{};  ///< if regular: the node blocks b + {0,1}³
  std::uint32_t first_region = 0, region_count = 0;    ///< otherwise: any number of regions
  bool regular() const { return region_count == 0; }
};

template <class T>
class NodeStore {
 public:
  /// The node blocks of the active particle blocks, found anew if their set has changed.
  /// `sparse`: only those that particles reach, otherwise all in the box around them.
  void follow(const ParticleStore<T>& particles, const TileShape& shape, bool sparse) {
    if (generation_ != particles.generation()) rebuild(particles, shape, sparse);
  }

  std::size_t size() const { return blocks_.size(); }
  const NodeBlock& block(std::size_t n) const { return blocks_[n]; }
  const Lattice& lattice() const { return lattice_; }

  T* tile(std::size_t active) const { return tiles_.data() + active * tile_size_; }
  T* gathered(std::size_t n) const { return gathered_.data() + n * gathered_size_; }

  /// The memory of all tiles for another use, at least `bytes`: they lose what they hold.
  std::span<std::byte> lend_tiles(std::size_t bytes) {
    const std::size_t n = (bytes + sizeof(T) - 1) / sizeof(T);
    tiles_.require(n, n / 8);
    return tiles_.lend();
  }
  /// The same for what is gathered from node blocks: gathered_bytes() for each.
  std::span<std::byte> lend_gathered() const { return gathered_.lend(); }
  std::size_t gathered_bytes() const { return gathered_size_ * sizeof(T); }

  const Surroundings& surroundings(std::size_t active) const { return surroundings_[active]; }
  std::span<const Share> shares(std::size_t n) const {
    return {shares_.data() + blocks_[n].first_share, blocks_[n].share_count};
  }

  struct RegionFrom {
    BlockNumber node_block;
    Region region;
  };
  std::span<const RegionFrom> regions(const Surroundings& s) const {
    return {regions_.data() + s.first_region, s.region_count};
  }

  /// The node values around an active block, from those of node block n at gathered(n).
  template <class Kernels, class Gathered, class Value>
  void load_surroundings(std::size_t active, const Kernels& kernels, const Gathered& gathered,
                         Value* local) const {
    const Surroundings& s = surroundings(active);
    if (s.regular()) {
      const Value* from[tile_corners];
      for (std::size_t k = 0; k < tile_corners; ++k) from[k] = gathered(s.node_block[k]);
      kernels.load_local(from, local);
    } else {
      for (const RegionFrom& from : regions(s))
        kernels.load_region(gathered(from.node_block), from.region, local);
    }
  }

  /// All fields of all nodes, where they are kept: stage by stage, or without the skips
  /// `fields` and `volumes`.
  NodeFields<T>& fields(std::size_t n) { return fields_[n]; }
  const NodeFields<T>& fields(std::size_t n) const { return fields_[n]; }
  void require_fields() { fields_.require(blocks_.size()); }

  /// A node by its node block and its place in it; found() is false if there is none.
  struct Place {
    BlockNumber block;
    int node;
    bool found() const { return block != no_block; }
  };
  Place find(const NodeIndex& i) const;
  /// The other way round: index of node `node` of node block n.
  NodeIndex index(std::size_t n, int node) const;

  std::size_t bytes() const;

 private:
  void rebuild(const ParticleStore<T>& particles, const TileShape& shape, bool sparse);
  BlockNumber find_or_create(const NodeIndex& c);
  void fill_box();

  std::uint64_t generation_ = 0;  ///< of the particles' set of blocks
  Lattice lattice_;
  std::vector<NodeBlock> blocks_;
  std::vector<Share> shares_;
  std::vector<Surroundings> surroundings_;
  std::vector<RegionFrom> regions_;
  std::vector<std::pair<BlockNumber, Share>> found_;  ///< (node block, share) before sorting
  BlockMap map_;
  AlignedArray<T> tiles_, gathered_;
  AlignedArray<NodeFields<T>> fields_;
  std::size_t tile_size_ = 0, gathered_size_ = 0;
};

extern template class NodeStore<float>;
extern template class NodeStore<double>;

}  // namespace firn::optimized
