// SPDX-License-Identifier: BSD-3-Clause
#include "reference/stencil.hpp"

#include <algorithm>

#include "reference/failure.hpp"

namespace firn::reference {

namespace {

using Period = std::array<int, 3>;  ///< nodes along each axis, 0 = open

/// i modulo n, in [0, n); i itself along an open axis (n = 0).
std::int32_t wrap_index(std::int32_t i, int n) { return n == 0 ? i : ((i % n) + n) % n; }

NodeIndex wrap(const NodeIndex& n, const Period& period) {
  return {wrap_index(n.i, period[0]), wrap_index(n.j, period[1]), wrap_index(n.k, period[2])};
}

/// The nodes of all cubes of width³ nodes that begin at one of `first`, sorted. Neighbouring
/// cubes share most of their nodes, so they are widened along one axis at a time: that leaves
/// the least to sort.
std::vector<NodeIndex> nodes_of_cubes(const std::vector<NodeIndex>& first, int width,
                                      const Period& period) {
  std::vector<NodeIndex> nodes = first;
  for (std::int32_t NodeIndex::*axis : {&NodeIndex::k, &NodeIndex::j, &NodeIndex::i}) {
    std::vector<NodeIndex> wider;
    wider.reserve(nodes.size() * static_cast<std::size_t>(width));
    for (NodeIndex n : nodes)
      for (int step = 0; step < width; ++step, ++(n.*axis)) wider.push_back(wrap(n, period));
    std::stable_sort(wider.begin(), wider.end());  // merges: faster where much is in order already
    wider.erase(std::unique(wider.begin(), wider.end()), wider.end());
    nodes = std::move(wider);
  }
  return nodes;
}

/// The place of n in a sorted list that has it; `guess` is looked at first.
std::size_t place_of(const NodeIndex& n, const std::vector<NodeIndex>& sorted, std::size_t guess) {
  if (guess < sorted.size() && sorted[guess] == n) return guess;
  const auto place = std::lower_bound(sorted.begin(), sorted.end(), n);
  return static_cast<std::size_t>(place - sorted.begin());
}

/// For each cube, one after the other, the places of its nodes in `node`, z fastest. Nodes that
/// follow each other along z are neighbours in the list, and so are, nearly always, cubes.
std::vector<std::int32_t> places_in_cubes(const std::vector<NodeIndex>& first, int width,
                                          const Period& period,
                                          const std::vector<NodeIndex>& node) {
  std::vector<std::int32_t> places;
  std::vector<std::size_t> row_begin(static_cast<std::size_t>(width * width), 0);
  places.reserve(first.size() * row_begin.size() * static_cast<std::size_t>(width));
  for (const NodeIndex& corner : first) {
    auto begin = row_begin.begin();
    for (int a = 0; a < width; ++a)
      for (int b = 0; b < width; ++b, ++begin) {
        std::size_t guess = *begin + 1;  // behind the row of the cube before
        for (int c = 0; c < width; ++c) {
          const NodeIndex n = wrap({corner.i + a, corner.j + b, corner.k + c}, period);
          const std::size_t i = place_of(n, node, guess);
          places.push_back(static_cast<std::int32_t>(i));
          if (c == 0) *begin = i;
          guess = i + 1;
        }
      }
  }
  return places;
}

}  // namespace

bool inside_domain(const GridSettings& grid, const Vec3& x) {
  const Vec3 cells = (x - grid.origin) / grid.spacing;
  return cells.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 0x1p30;
}

void Stencils::build(const Scene& scene, const Particles& particles, Stage stage,
                     std::vector<NodeIndex>& node) {
  kernel_ = Kernel(scene.grid);
  const Period period{scene.grid.period_nodes(0), scene.grid.period_nodes(1),
                      scene.grid.period_nodes(2)};
  struct FirstNode {
    NodeIndex node;
    std::size_t p;
  };
  std::vector<FirstNode> first_nodes(particles.size());
  stencils_.resize(particles.size());
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Vec3& x_p = particles.x[p];
    if (!inside_domain(scene.grid, x_p)) fail_at_particle(stage, p, outside_domain(x_p));
    auto& [x, y, z] = stencils_[p].row;
    x = kernel_.row(0, x_p[0]);
    y = kernel_.row(1, x_p[1]);
    z = kernel_.row(2, x_p[2]);
    first_nodes[p] = {wrap({x.first, y.first, z.first}, period), p};
  }
  std::sort(first_nodes.begin(), first_nodes.end(),
            [](const FirstNode& a, const FirstNode& b) { return a.node < b.node; });

  std::vector<NodeIndex> cubes;  // particles with the same first node touch the same nodes
  for (const FirstNode& first : first_nodes) {
    if (cubes.empty() || !(cubes.back() == first.node)) cubes.push_back(first.node);
    stencils_[first.p].cube = cubes.size() - 1;
  }
  node = nodes_of_cubes(cubes, kernel_.width, period);
  places_ = places_in_cubes(cubes, kernel_.width, period, node);
}

double Stencils::bytes() const {
  return static_cast<double>(stencils_.capacity() * sizeof(Stencil) +
                             places_.capacity() * sizeof(places_[0]));
}

}  // namespace firn::reference
