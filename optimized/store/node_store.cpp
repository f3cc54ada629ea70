// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/store/node_store.hpp"

#include <algorithm>

namespace firn::optimized {

template <class T>
BlockNumber NodeStore<T>::find_or_create(const NodeIndex& c) {
  const auto fresh = static_cast<BlockNumber>(blocks_.size());
  const BlockNumber n = map_.find_or_insert(c, fresh);
  if (n == fresh) blocks_.push_back({c, 0, 0});
  return n;
}

template <class T>
void NodeStore<T>::rebuild(const ParticleStore<T>& particles, const TileShape& shape, bool sparse) {
  lattice_ = particles.lattice();
  generation_ = particles.generation();
  tile_size_ = shape.tile_size;
  gathered_size_ = shape.gathered_size;
  const std::size_t active = particles.active().size();
  map_.reset(2 * active);
  blocks_.clear(), surroundings_.clear(), regions_.clear(), found_.clear();

  std::vector<Overlap> along[3];
  for (BlockNumber a = 0; a < active; ++a) {
    const NodeIndex& b = particles.active_block(a).b;
    lattice_.overlaps(0, b.i, along[0]);
    lattice_.overlaps(1, b.j, along[1]);
    lattice_.overlaps(2, b.k, along[2]);
    Surroundings s;
    const bool regular = std::all_of(along, along + 3, [](const std::vector<Overlap>& overlaps) {
      return overlaps.size() == 2 && overlaps[0].size == block_cells;
    });
    s.first_region = static_cast<std::uint32_t>(regions_.size());
    std::size_t corner = 0;
    for (const Overlap& x : along[0])
      for (const Overlap& y : along[1])
        for (const Overlap& z : along[2]) {
          const BlockNumber n = find_or_create({x.block, y.block, z.block});
          const Region region{
              {x.tile, y.tile, z.tile}, {x.node, y.node, z.node}, {x.size, y.size, z.size}};
          found_.push_back({n, {a, region}});
          if (regular)
            s.node_block[corner++] = n;
          else
            regions_.push_back({n, region});
        }
    s.region_count = static_cast<std::uint32_t>(regions_.size()) - s.first_region;
    surroundings_.push_back(s);
  }

  if (!sparse) fill_box();

  // Shares by node block, in the order of the particle blocks (sorted by position).
  for (const auto& [n, share] : found_) ++blocks_[n].share_count;
  std::uint32_t first = 0;
  for (NodeBlock& block : blocks_) {
    block.first_share = first;
    first += block.share_count;
    block.share_count = 0;
  }
  shares_.resize(found_.size());
  for (const auto& [n, share] : found_) {
    NodeBlock& block = blocks_[n];
    shares_[block.first_share + block.share_count++] = share;
  }
  tiles_.require(active * tile_size_);
  gathered_.require(blocks_.size() * gathered_size_);
}

template <class T>
void NodeStore<T>::fill_box() {
  if (blocks_.empty()) return;
  NodeIndex low = blocks_.front().c, high = low;
  for (const NodeBlock& block : blocks_) {
    low = {std::min(low.i, block.c.i), std::min(low.j, block.c.j), std::min(low.k, block.c.k)};
    high = {std::max(high.i, block.c.i), std::max(high.j, block.c.j), std::max(high.k, block.c.k)};
  }
  for (std::int32_t i = low.i; i <= high.i; ++i)
    for (std::int32_t j = low.j; j <= high.j; ++j)
      for (std::int32_t k = low.k; k <= high.k; ++k) find_or_create({i, j, k});
}

template <class T>
auto NodeStore<T>::find(const NodeIndex& i) const -> Place {
  NodeIndex c;
  int x = 0, y = 0, z = 0;
  lattice_.find_node(0, i.i, c.i, x);
  lattice_.find_node(1, i.j, c.j, y);
  lattice_.find_node(2, i.k, c.k, z);
  return {map_.find(c), number_in_block(x, y, z)};
}

template <class T>
NodeIndex NodeStore<T>::index(std::size_t n, int node) const {
  const NodeIndex& c = blocks_[n].c;
  return {lattice_.node_index(0, c.i, node / rows_per_block),
          lattice_.node_index(1, c.j, node / block_cells % block_cells),
          lattice_.node_index(2, c.k, node % block_cells)};
}

template <class T>
std::size_t NodeStore<T>::bytes() const {
  return tiles_.bytes() + gathered_.bytes() + fields_.bytes() +
         blocks_.capacity() * sizeof(NodeBlock) + shares_.capacity() * sizeof(Share) +
         surroundings_.capacity() * sizeof(Surroundings) +
         regions_.capacity() * sizeof(RegionFrom) + found_.capacity() * sizeof(found_[0]);
}

template class NodeStore<float>;
template class NodeStore<double>;

}  // namespace firn::optimized
