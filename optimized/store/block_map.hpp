// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Block coordinates to numbers: a hash table with open addressing.

#include <cstdint>
#include <limits>
#include <vector>

#include "firn/types.hpp"

namespace firn::optimized {

/// Block coordinates lie within ±2^20, so that three fit into 64 bits.
inline constexpr std::int32_t block_limit = 1 << 20;

/// Place of a block in a list of blocks, as it is stored; a std::size_t where it is used.
using BlockNumber = std::uint32_t;
inline constexpr BlockNumber no_block = std::numeric_limits<BlockNumber>::max();

class BlockMap {
 public:
  /// Forgets everything; room for n keys without growing.
  void reset(std::size_t n);

  /// The number at b, no_block if there is none.
  BlockNumber find(const NodeIndex& b) const;

  /// The number at b; `fresh` takes its place if there was none.
  BlockNumber find_or_insert(const NodeIndex& b, BlockNumber fresh);

 private:
  struct Entry {
    std::uint64_t key;
    BlockNumber number;
  };
  static constexpr std::uint64_t nobody = ~std::uint64_t{0};

  static std::uint64_t key_of(const NodeIndex& b);
  std::size_t place_of(std::uint64_t key) const;
  void grow();

  std::vector<Entry> entries_;
  std::size_t used_ = 0;
};

}  // namespace firn::optimized
