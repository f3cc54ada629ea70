#pragma once
/// Block coordinates to numbers: a hash table with open addressing.

#include <cstdint>
#include <vector>

#include "firn/types.hpp"

namespace firn::optimized {

/// Block coordinates lie within ±2^20, so that three fit into 64 bits.
inline constexpr std::int32_t block_limit = 1 << 20;

class BlockMap {
 public:
  /// Forgets everything; room for n keys without growing.
  void reset(std::size_t n);

  /// The number at b, −1 if there is none.
  int find(const NodeIndex& b) const;

  /// The number at b; `fresh` takes its place if there was none.
  int find_or_insert(const NodeIndex& b, int fresh);

 private:
  struct Entry {
    std::uint64_t key;
    int number;
  };
  static constexpr std::uint64_t nobody = ~std::uint64_t{0};

  static std::uint64_t key_of(const NodeIndex& b);
  std::size_t place_of(std::uint64_t key) const;
  void grow();

  std::vector<Entry> entries_;
  std::size_t used_ = 0;
};

}  // namespace firn::optimized
