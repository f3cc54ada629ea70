// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/store/block_map.hpp"

#include <bit>

namespace firn::optimized {

std::uint64_t BlockMap::key_of(const NodeIndex& b) {
  const auto part = [](std::int32_t v) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v + block_limit));
  };
  return (part(b.i) << 42) | (part(b.j) << 21) | part(b.k);
}

std::size_t BlockMap::place_of(std::uint64_t key) const {
  const std::size_t mask = entries_.size() - 1;
  // Fibonacci hashing: the high bits of the product depend on all bits of the key.
  std::size_t place = (key * 0x9E3779B97F4A7C15u) >> 32 & mask;
  while (entries_[place].key != nobody && entries_[place].key != key) place = (place + 1) & mask;
  return place;
}

void BlockMap::reset(std::size_t n) {
  const std::size_t size = std::bit_ceil(2 * n + 16);
  if (entries_.size() < size) entries_.resize(size);
  for (Entry& e : entries_) e = {nobody, no_block};
  used_ = 0;
}

BlockNumber BlockMap::find(const NodeIndex& b) const {
  if (entries_.empty()) return no_block;
  return entries_[place_of(key_of(b))].number;
}

BlockNumber BlockMap::find_or_insert(const NodeIndex& b, BlockNumber fresh) {
  if (2 * (used_ + 1) > entries_.size()) grow();
  Entry& e = entries_[place_of(key_of(b))];
  if (e.key == nobody) {
    e = {key_of(b), fresh};
    ++used_;
  }
  return e.number;
}

void BlockMap::grow() {
  std::vector<Entry> old;
  old.swap(entries_);
  entries_.assign(std::bit_ceil(2 * old.size() + 16), Entry{nobody, no_block});
  for (const Entry& e : old)
    if (e.key != nobody) entries_[place_of(e.key)] = e;
}

}  // namespace firn::optimized
