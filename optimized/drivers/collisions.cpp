// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/drivers/collisions.hpp"

#include <cmath>

namespace firn::optimized {

namespace {

/// The colliders that may touch something within a cube of half width `half` [h] around `center`
/// [h], in coordinates of the grid.
template <class T>
void colliders_near(const Simulation<T>& sim, const Vec3& center, double half,
                    std::vector<std::size_t>& colliders) {
  const double h = sim.scene->grid.spacing;
  sim.contacts.near(sim.scene->grid.origin + h * center, half * std::sqrt(3.0) * h, colliders);
}

/// Node −1 of a periodic axis is node n−1, far from the block's others.
template <class T>
bool is_split(const Simulation<T>& sim, const NodeIndex& c) {
  const Lattice& lattice = sim.nodes.lattice();
  return (lattice.period(0) > 0 && c.i == 0) || (lattice.period(1) > 0 && c.j == 0) ||
         (lattice.period(2) > 0 && c.k == 0);
}

}  // namespace

template <class T>
void collide_nodes(Simulation<T>& sim, std::size_t n, std::vector<std::size_t>& colliders,
                   NodeFields<T>& node) {
  if (sim.scene->colliders.empty()) return;
  const NodeIndex& c = sim.nodes.block(n).c;
  if (sim.skips.contact && !is_split(sim, c))  // nodes 4c − 1 … 4c + 2
    colliders_near(sim, block_cells * Vec3(c.i, c.j, c.k) + Vec3::Constant(0.5), 1.5, colliders);
  else
    sim.contacts.all(colliders);
  if (colliders.empty()) return;
  for (int k = 0; k < nodes_per_block; ++k) {
    if (!(node.m[k] > 0)) continue;
    const NodeIndex i = sim.nodes.index(n, k);
    const Vec3 x = sim.scene->grid.origin + sim.scene->grid.spacing * Vec3(i.i, i.j, i.k);
    Vec3 v(static_cast<double>(node.v_star[0][k]), static_cast<double>(node.v_star[1][k]),
           static_cast<double>(node.v_star[2][k]));
    if (sim.semi_implicit()) {
      Mat3 free = Mat3::Identity();
      sim.contacts.collide(colliders, x, v, free);
      if (free != Mat3::Identity()) sim.implicit.free.set(n, k, free);
    } else {
      sim.contacts.collide(colliders, x, v);
    }
    for (int a = 0; a < 3; ++a) node.v_star[a][k] = static_cast<T>(v[a]);
  }
}

template <class T>
void find_colliders(const Simulation<T>& sim, const Block<T>& block,
                    std::vector<std::size_t>& colliders) {
  if (!sim.skips.contact) return sim.contacts.all(colliders);
  const Vec3 b(block.b.i, block.b.j, block.b.k);
  colliders_near(sim, block_cells * b + Vec3::Constant(2), 2, colliders);  // cells 4b … 4b + 3
}

template <class T>
void collide_particles(const Simulation<T>& sim, const Block<T>& block,
                       const std::vector<std::size_t>& colliders) {
  for (std::size_t i = 0; i < block.count; ++i) {
    Vec3 v = sim.particles.vector(block, i, slot_v);
    const Vec3 before = v;
    sim.contacts.collide(colliders, sim.particles.position(block, i), v);
    if (v == before) continue;
    for (int a = 0; a < 3; ++a) sim.particles.value(block, i, slot_v + a) = static_cast<T>(v[a]);
  }
}

template void collide_nodes(Simulation<float>&, std::size_t, std::vector<std::size_t>&,
                            NodeFields<float>&);
template void collide_nodes(Simulation<double>&, std::size_t, std::vector<std::size_t>&,
                            NodeFields<double>&);
template void find_colliders(const Simulation<float>&, const Block<float>&,
                             std::vector<std::size_t>&);
template void find_colliders(const Simulation<double>&, const Block<double>&,
                             std::vector<std::size_t>&);
template void collide_particles(const Simulation<float>&, const Block<float>&,
                                const std::vector<std::size_t>&);
template void collide_particles(const Simulation<double>&, const Block<double>&,
                                const std::vector<std::size_t>&);

}  // namespace firn::optimized
