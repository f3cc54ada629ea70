#include "reference/stencil.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "reference/failure.hpp"
#include "reference/kernel.hpp"

namespace firn::reference {

namespace {

constexpr double largest_index = 1 << 30;

/// i modulo n, in [0, n); i itself along an open axis (n = 0).
std::int32_t wrap_index(std::int32_t i, int n) { return n == 0 ? i : ((i % n) + n) % n; }

NodeIndex wrap_index(const NodeIndex& n, const std::array<int, 3>& period) {
  return {wrap_index(n.i, period[0]), wrap_index(n.j, period[1]), wrap_index(n.k, period[2])};
}

std::array<int, 3> period_nodes(const GridSettings& grid) {
  return {grid.period_nodes(0), grid.period_nodes(1), grid.period_nodes(2)};
}

}  // namespace

std::size_t SparseNumbers::Hash::operator()(const NodeIndex& block) const {
  // Multiplication by large odd numbers spreads neighbours over the table.
  const auto bits = [](std::int32_t i) { return static_cast<std::uint64_t>(i); };
  std::uint64_t h = bits(block.i) * 0x9e3779b97f4a7c15u;
  h = (h ^ (h >> 32) ^ bits(block.j)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 32) ^ bits(block.k)) * 0x94d049bb133111ebu;
  return static_cast<std::size_t>(h ^ (h >> 32));
}

std::int32_t& SparseNumbers::operator[](const NodeIndex& n) {
  const NodeIndex block{n.i >> 2, n.j >> 2, n.k >> 2};
  if (last_ == nullptr || !(block == last_block_)) {
    const auto [entry, is_new] = blocks_.try_emplace(block);
    if (is_new) entry->second.fill(-1);
    last_block_ = block;
    last_ = &entry->second;
  }
  return (*last_)[static_cast<std::size_t>((n.i & 3) * 16 + (n.j & 3) * 4 + (n.k & 3))];
}

void SparseNumbers::clear() {
  blocks_.clear();
  last_ = nullptr;
}

void Stencils::build(const Scene& scene, const Particles& particles, Stage stage,
                     std::vector<NodeIndex>& node) {
  weights_.resize(particles.size());
  first_node_of_cell_.clear();
  cell_number_.clear();
  for (std::size_t p = 0; p < particles.size(); ++p) weigh(scene, particles, stage, p);
  number_nodes(scene, node);
}

double Stencils::bytes() const {
  return static_cast<double>(weights_.capacity() * sizeof(Weights) +
                             nodes_of_cell_.capacity() * sizeof(nodes_of_cell_[0]));
}

/// The first of the four nodes along an axis is the one before the cell:
/// floor((x_p − origin)/h) − 1. Floor, not truncation: coordinates may be negative.
void Stencils::weigh(const Scene& scene, const Particles& particles, Stage stage, std::size_t p) {
  const double h = scene.grid.spacing;
  Weights& w = weights_[p];
  std::array<std::int32_t, 3> first;
  for (int axis = 0; axis < 3; ++axis) {
    const double X = (particles.x[p][axis] - scene.grid.origin[axis]) / h;
    const double cell = std::floor(X);
    if (!finite(X)) fail_at_particle(stage, p, "position is not finite");
    if (std::abs(cell) > largest_index)
      fail_at_particle(stage, p,
                       "outside the representable domain: cell index " + to_text(cell) +
                           ", allowed: -2^30 .. 2^30");
    first[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(cell) - 1;
    kernel_row(X - cell, w.N[axis], w.dN[axis]);
    for (double& dN : w.dN[axis]) dN /= h;
  }
  const NodeIndex first_node = wrap_index({first[0], first[1], first[2]}, period_nodes(scene.grid));
  std::int32_t& cell = cell_number_[first_node];
  if (cell < 0) {
    cell = static_cast<std::int32_t>(first_node_of_cell_.size());
    first_node_of_cell_.push_back(first_node);
  }
  w.cell = cell;
}

/// Nodes get numbers as the cells meet them; sorting them permutes the numbers.
void Stencils::number_nodes(const Scene& scene, std::vector<NodeIndex>& node) {
  const std::array<int, 3> period = period_nodes(scene.grid);
  std::vector<NodeIndex> met;
  node_number_.clear();
  nodes_of_cell_.resize(first_node_of_cell_.size());
  for (std::size_t cell = 0; cell < nodes_of_cell_.size(); ++cell) {
    const NodeIndex first = first_node_of_cell_[cell];
    auto place = nodes_of_cell_[cell].begin();
    for (std::int32_t a = 0; a < 4; ++a)
      for (std::int32_t b = 0; b < 4; ++b)
        for (std::int32_t c = 0; c < 4; ++c) {
          const NodeIndex n = wrap_index({first.i + a, first.j + b, first.k + c}, period);
          std::int32_t& number = node_number_[n];
          if (number < 0) {
            number = static_cast<std::int32_t>(met.size());
            met.push_back(n);
          }
          *place++ = number;
        }
  }

  std::vector<std::int32_t> order(met.size()), rank(met.size());
  std::iota(order.begin(), order.end(), 0);
  const auto at = [](std::int32_t i) { return static_cast<std::size_t>(i); };
  std::sort(order.begin(), order.end(),
            [&](std::int32_t a, std::int32_t b) { return met[at(a)] < met[at(b)]; });
  node.resize(met.size());
  for (std::size_t place = 0; place < order.size(); ++place) {
    node[place] = met[at(order[place])];
    rank[at(order[place])] = static_cast<std::int32_t>(place);
  }
  for (auto& nodes : nodes_of_cell_)
    for (std::int32_t& number : nodes) number = rank[at(number)];
}

}  // namespace firn::reference
