// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Where blocks and node blocks lie, along open and periodic axes.
///
/// Cell c lies between nodes c and c+1. Particle block b holds cells 4b … 4b+3,
/// its tile nodes 4b−1 … 4b+5. Node block c holds nodes 4c−1 … 4c+2, so that the
/// tile of block b meets node blocks b and b+1. Along a periodic axis of n cells
/// the last block has n − 4⌊(n−1)/4⌋ cells, and node n−1 belongs to block 0 as
/// node −1.

#include <vector>

#include "firn/scene.hpp"
#include "optimized/store/layout.hpp"

namespace firn::optimized {

/// `size` consecutive nodes that are tile nodes from `tile` on and nodes of node
/// block `block` from `node` on.
struct Overlap {
  std::int32_t block;
  int tile, node, size;
};

class Lattice {
 public:
  Lattice() = default;
  explicit Lattice(const GridSettings& grid);

  double spacing() const { return h_; }
  const Vec3& origin() const { return origin_; }

  /// Number of cells along a periodic axis, 0 along an open one.
  int period(int axis) const { return period_[axis]; }

  /// Cells of block b along an axis: 4, less at the end of a period.
  int cells(int axis, std::int32_t b) const;

  /// Block and position inside it, in units of h, of a point at distance X·h from
  /// the origin. X is finite and its block within ±block_limit.
  void locate(int axis, double X, std::int32_t& b, double& x) const;

  /// The position moved from block b to where it belongs (0 ≤ x < cells).
  template <class Number>
  void settle(int axis, std::int32_t& b, Number& x, Number one) const {
    const int n = period_[axis];
    const std::int32_t last = n > 0 ? (n - 1) / block_cells : 0;
    while (x < 0) {
      b = n > 0 && b == 0 ? last : b - 1;
      x += static_cast<Number>(cells(axis, b)) * one;
    }
    for (Number width; x >= (width = static_cast<Number>(cells(axis, b)) * one);) {
      x -= width;
      b = n > 0 && b == last ? 0 : b + 1;
    }
  }

  /// The node blocks that a tile meets, in tile order.
  void overlaps(int axis, std::int32_t b, std::vector<Overlap>& out) const;

  /// Index along an axis of node k of node block c, wrapped into the period.
  std::int32_t node_index(int axis, std::int32_t c, int k) const;

  /// Node block and place in it of the node with index i.
  void find_node(int axis, std::int32_t i, std::int32_t& c, int& k) const;

 private:
  double h_ = 1;
  Vec3 origin_ = Vec3::Zero();
  int period_[3] = {0, 0, 0};
};

}  // namespace firn::optimized
