#pragma once
/// The node blocks that the particles reach, who contributes to each, and who
/// gathers from where.

#include <array>
#include <cstddef>
#include <vector>

#include "firn/state.hpp"
#include "optimized/passes/kernel_table.hpp"
#include "optimized/store/memory.hpp"
#include "optimized/store/particle_store.hpp"

namespace firn::optimized {

/// One tile's share in a node block: tile nodes from `tile` on are the block's
/// nodes from `node` on.
struct Share {
  int tile_number;  ///< place among the active particle blocks
  Region region;
};

struct NodeBlock {
  NodeIndex c;  ///< holds nodes 4c−1 … 4c+2
  int first_share = 0, share_count = 0;
};

/// Where a particle block's 7×7×7 nodes come from.
struct Surroundings {
  std::array<int, 8> node_block{};          ///< regular: the node blocks b + {0,1}³
  int first_region = -1, region_count = 0;  ///< otherwise: any number of regions
};

template <class T>
class NodeStore {
 public:
  /// From the active particle blocks; call whenever their set has changed. `sparse`: only
  /// blocks that particles reach, otherwise all in the box around them.
  void rebuild(const ParticleStore<T>& particles, const TileShape& shape, bool sparse);

  std::size_t size() const { return blocks_.size(); }
  const NodeBlock& block(std::size_t n) const { return blocks_[n]; }
  const Lattice& lattice() const { return lattice_; }

  T* tile(std::size_t active) const { return tiles_.data() + active * tile_size_; }
  /// The memory of all tiles for another use, at least `bytes`: they lose what they hold.
  std::byte* tile_memory(std::size_t bytes) {
    const std::size_t n = (bytes + sizeof(T) - 1) / sizeof(T);
    tiles_.require(n, n / 8);
    return reinterpret_cast<std::byte*>(tiles_.data());
  }
  T* gathered(std::size_t n) const { return gathered_.data() + n * gathered_size_; }
  /// Memory of one node block's (v_new, u).
  std::size_t gathered_bytes() const { return gathered_size_ * sizeof(T); }
  const Surroundings& surroundings(std::size_t active) const { return surroundings_[active]; }
  const Share* shares(const NodeBlock& block) const {
    return shares_.data() + static_cast<std::size_t>(block.first_share);
  }

  struct RegionFrom {
    int node_block;
    Region region;
  };
  const RegionFrom* regions(const Surroundings& s) const {
    return regions_.data() + static_cast<std::size_t>(s.first_region);
  }

  /// The node values around an active block, from those of node block n at gathered(n).
  template <class Kernels, class Gathered, class Value>
  void load_surroundings(std::size_t active, const Kernels& kernels, const Gathered& gathered,
                         Value* local) const {
    const Surroundings& s = surroundings(active);
    if (s.first_region < 0) {
      const Value* from[8];
      for (std::size_t k = 0; k < 8; ++k)
        from[k] = gathered(static_cast<std::size_t>(s.node_block[k]));
      kernels.load_local(from, local);
    } else {
      for (int k = 0; k < s.region_count; ++k) {
        const RegionFrom& from = regions(s)[k];
        kernels.load_region(gathered(static_cast<std::size_t>(from.node_block)), from.region,
                            local);
      }
    }
  }

  /// All fields of all nodes, where they are kept: stage by stage, or without the skips
  /// `fields` and `volumes`.
  NodeFields<T>& fields(std::size_t n) { return fields_[n]; }
  const NodeFields<T>& fields(std::size_t n) const { return fields_[n]; }
  void require_fields() { fields_.require(blocks_.size()); }

  /// Number of the node block at c, −1 if there is none.
  int find(const NodeIndex& c) const { return map_.find(c); }

  NodeIndex index(const NodeBlock& block, int place) const;

  std::size_t bytes() const;

 private:
  int find_or_create(const NodeIndex& c);
  void fill_box();

  Lattice lattice_;
  std::vector<NodeBlock> blocks_;
  std::vector<Share> shares_;
  std::vector<Surroundings> surroundings_;
  std::vector<RegionFrom> regions_;
  std::vector<std::pair<int, Share>> found_;  ///< (node block, share) before sorting
  BlockMap map_;
  AlignedArray<T> tiles_, gathered_;
  AlignedArray<NodeFields<T>> fields_;
  std::size_t tile_size_ = 0, gathered_size_ = 0;
};

extern template class NodeStore<float>;
extern template class NodeStore<double>;

}  // namespace firn::optimized
