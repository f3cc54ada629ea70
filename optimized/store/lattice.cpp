// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/store/lattice.hpp"

#include <cmath>

namespace firn::optimized {

namespace {

std::int32_t floor_div(std::int32_t a, std::int32_t b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

}  // namespace

Lattice::Lattice(const GridSettings& grid) : h_(grid.spacing), origin_(grid.origin) {
  for (int axis = 0; axis < 3; ++axis) period_[axis] = grid.period_nodes(axis);
}

int Lattice::cells(int axis, std::int32_t b) const {
  const int n = period_[axis];
  if (n == 0 || b < (n - 1) / block_cells) return block_cells;
  return n - (n - 1) / block_cells * block_cells;
}

void Lattice::locate(int axis, double X, std::int32_t& b, double& x) const {
  b = static_cast<std::int32_t>(std::floor(X / block_cells));
  x = X - static_cast<double>(block_cells) * b;  // exact: a multiple of X's last digit
  if (period_[axis] == 0) return;
  const std::int32_t last = (period_[axis] - 1) / block_cells;
  if (b < 0) x += static_cast<double>(block_cells) * b, b = 0;
  if (b > last) x += static_cast<double>(block_cells) * (b - last), b = last;
  settle(axis, b, x, 1.0);
}

void Lattice::overlaps(int axis, std::int32_t b, std::vector<Overlap>& out) const {
  out.clear();
  for (int q = 0; q < tile_nodes; ++q) {
    std::int32_t c;
    int k;
    find_node(axis, block_cells * b - 1 + q, c, k);
    if (!out.empty() && out.back().block == c && out.back().node + out.back().size == k)
      ++out.back().size;
    else
      out.push_back({c, q, k, 1});
  }
}

std::int32_t Lattice::node_index(int axis, std::int32_t c, int k) const {
  const std::int32_t i = block_cells * c - 1 + k;
  return i < 0 && period_[axis] > 0 ? i + period_[axis] : i;
}

void Lattice::find_node(int axis, std::int32_t i, std::int32_t& c, int& k) const {
  std::int32_t shifted = i + 1;  // 4c + k
  if (const int n = period_[axis]; n > 0) {
    shifted %= n;
    if (shifted < 0) shifted += n;
  }
  c = floor_div(shifted, block_cells);
  k = static_cast<int>(shifted - block_cells * c);
}

}  // namespace firn::optimized
