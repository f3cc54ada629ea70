#include "reference/stencil.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "reference/failure.hpp"
#include "reference/kernel.hpp"

namespace firn::reference {

namespace {

/// i modulo n, in [0, n); i itself along an open axis (n = 0).
std::int32_t wrap_index(std::int32_t i, int n) { return n == 0 ? i : ((i % n) + n) % n; }

}  // namespace

bool inside_domain(const GridSettings& grid, const Vec3& x) {
  const Vec3 cells = (x - grid.origin) / grid.spacing;
  return cells.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 0x1p30;
}

std::size_t SparseNumbers::Hash::operator()(const NodeIndex& block) const {
  // Multiplication by large odd numbers spreads neighbours over the table.
  const auto bits = [](std::int32_t i) { return static_cast<std::uint64_t>(i); };
  std::uint64_t h = bits(block.i) * 0x9e3779b97f4a7c15u;
  h = (h ^ (h >> 32) ^ bits(block.j)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 32) ^ bits(block.k)) * 0x94d049bb133111ebu;
  return static_cast<std::size_t>(h ^ (h >> 32));
}

std::int32_t& SparseNumbers::operator[](const NodeIndex& n) {
  const auto place_of_64 = [](const NodeIndex& m) {
    return static_cast<std::size_t>((m.i & 3) * 16 + (m.j & 3) * 4 + (m.k & 3));
  };
  const NodeIndex block{n.i >> 2, n.j >> 2, n.k >> 2};
  Recent& recent = recent_[place_of_64(block)];
  if (recent.numbers == nullptr || !(recent.block == block)) {
    const auto [entry, is_new] = blocks_.try_emplace(block);
    if (is_new) entry->second.fill(-1);
    recent = {block, &entry->second};
  }
  return (*recent.numbers)[place_of_64(n)];
}

void SparseNumbers::clear() {
  blocks_.clear();
  recent_.fill({});
}

void Stencils::build(const Scene& scene, const Particles& particles, Stage stage,
                     std::vector<NodeIndex>& node) {
  for (int axis = 0; axis < 3; ++axis)
    period_[static_cast<std::size_t>(axis)] = scene.grid.period_nodes(axis);
  weights_.resize(particles.size());
  first_node_of_cell_.clear();
  cell_number_.clear();
  for (std::size_t p = 0; p < particles.size(); ++p) weigh(scene, particles, stage, p);
  number_nodes(node);
}

double Stencils::bytes() const {
  return static_cast<double>(weights_.capacity() * sizeof(Weights) +
                             nodes_of_cell_.capacity() * sizeof(nodes_of_cell_[0]));
}

/// The first of the four nodes along an axis is the one before the cell:
/// floor((x_p − origin)/h) − 1. Floor, not truncation: coordinates may be negative.
void Stencils::weigh(const Scene& scene, const Particles& particles, Stage stage, std::size_t p) {
  const double h = scene.grid.spacing;
  const Vec3& x_p = particles.x[p];
  if (!inside_domain(scene.grid, x_p)) fail_at_particle(stage, p, outside_domain(x_p));
  Weights& w = weights_[p];
  std::array<std::int32_t, 3> first;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const double X = (x_p[a] - scene.grid.origin[a]) / h;
    const double cell = std::floor(X);
    first[axis] = wrap_index(static_cast<std::int32_t>(cell) - 1, period_[axis]);
    kernel_row(X - cell, w.N[axis], w.dN[axis]);
    for (double& dN : w.dN[axis]) dN /= h;
  }
  const NodeIndex first_node{first[0], first[1], first[2]};
  std::int32_t& cell = cell_number_[first_node];
  if (cell < 0) {
    cell = static_cast<std::int32_t>(first_node_of_cell_.size());
    first_node_of_cell_.push_back(first_node);
  }
  w.cell = cell;
}

/// Nodes get numbers as the cells meet them; sorting them permutes the numbers.
void Stencils::number_nodes(std::vector<NodeIndex>& node) {
  std::vector<NodeIndex> met;
  node_number_.clear();
  nodes_of_cell_.resize(first_node_of_cell_.size());
  for (std::size_t cell = 0; cell < nodes_of_cell_.size(); ++cell) {
    const NodeIndex first = first_node_of_cell_[cell];
    auto place = nodes_of_cell_[cell].begin();
    for (std::int32_t a = 0; a < 4; ++a)
      for (std::int32_t b = 0; b < 4; ++b) {
        NodeIndex n{wrap_index(first.i + a, period_[0]), wrap_index(first.j + b, period_[1]), 0};
        std::int32_t* number = nullptr;
        for (std::int32_t c = 0; c < 4; ++c) {
          n.k = wrap_index(first.k + c, period_[2]);
          number = c > 0 && n.k % 4 != 0 ? number + 1 : &node_number_[n];
          if (*number < 0) {
            *number = static_cast<std::int32_t>(met.size());
            met.push_back(n);
          }
          *place++ = *number;
        }
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
