#include "optimized/store/node_store.hpp"

#include <algorithm>

namespace firn::optimized {

template <class T>
int NodeStore<T>::find_or_create(const NodeIndex& c) {
  const int fresh = static_cast<int>(blocks_.size());
  const int n = map_.find_or_insert(c, fresh);
  if (n == fresh) blocks_.push_back({c, 0, 0});
  return n;
}

template <class T>
void NodeStore<T>::rebuild(const ParticleStore<T>& particles, const TileShape& shape, bool sparse) {
  lattice_ = particles.lattice();
  tile_size_ = static_cast<std::size_t>(shape.tile_size);
  gathered_size_ = static_cast<std::size_t>(shape.gathered_size);
  const std::vector<int>& active = particles.active();
  map_.reset(2 * active.size());
  blocks_.clear(), surroundings_.clear(), regions_.clear(), found_.clear();

  std::vector<Overlap> along[3];
  for (std::size_t a = 0; a < active.size(); ++a) {
    const NodeIndex& b = particles.block(active[a]).b;
    lattice_.overlaps(0, b.i, along[0]);
    lattice_.overlaps(1, b.j, along[1]);
    lattice_.overlaps(2, b.k, along[2]);
    Surroundings s;
    const bool regular = along[0].size() == 2 && along[0][0].size == 4 && along[1].size() == 2 &&
                         along[1][0].size == 4 && along[2].size() == 2 && along[2][0].size == 4;
    if (!regular) s.first_region = static_cast<int>(regions_.size());
    int corner = 0;
    for (const Overlap& x : along[0])
      for (const Overlap& y : along[1])
        for (const Overlap& z : along[2]) {
          const int n = find_or_create({x.block, y.block, z.block});
          const Region region{
              {x.tile, y.tile, z.tile}, {x.node, y.node, z.node}, {x.size, y.size, z.size}};
          found_.push_back({n, {static_cast<int>(a), region}});
          if (regular)
            s.node_block[static_cast<std::size_t>(corner++)] = n;
          else
            regions_.push_back({n, region});
        }
    if (!regular) s.region_count = static_cast<int>(regions_.size()) - s.first_region;
    surroundings_.push_back(s);
  }

  if (!sparse) fill_box();

  // Shares by node block, in the order of the particle blocks (sorted by position).
  for (const auto& [n, share] : found_) ++blocks_[static_cast<std::size_t>(n)].share_count;
  int first = 0;
  for (NodeBlock& block : blocks_) {
    block.first_share = first;
    first += block.share_count;
    block.share_count = 0;
  }
  shares_.resize(found_.size());
  for (const auto& [n, share] : found_) {
    NodeBlock& block = blocks_[static_cast<std::size_t>(n)];
    shares_[static_cast<std::size_t>(block.first_share + block.share_count++)] = share;
  }
  tiles_.require(active.size() * tile_size_);
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
NodeIndex NodeStore<T>::index(const NodeBlock& block, int place) const {
  return {lattice_.node_index(0, block.c.i, place / 16),
          lattice_.node_index(1, block.c.j, place / 4 % 4),
          lattice_.node_index(2, block.c.k, place % 4)};
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
