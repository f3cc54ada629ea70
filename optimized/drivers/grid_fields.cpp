// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/drivers/grid_fields.hpp"

#include <algorithm>
#include <vector>

namespace firn::optimized {

namespace {

/// Which fields the stages before sim.next have written.
struct Written {
  bool forces, v_star, free_directions, v_new;
};

template <class T>
Written written_by_stages(const Simulation<T>& sim) {
  const auto over = [&](Stage stage) { return number(sim.next) > number(stage); };
  return {over(Stage::grid_forces), over(Stage::grid_velocities),
          sim.semi_implicit() && over(Stage::grid_collisions), over(Stage::integration)};
}

template <class T>
Vec3 at_node(const T (&field)[3][nodes_per_block], int k) {
  return Vec3(static_cast<double>(field[0][k]), static_cast<double>(field[1][k]),
              static_cast<double>(field[2][k]));
}

/// Nothing if the state holds no such field.
template <class T>
void set_at_node(const std::vector<Vec3>& from, std::size_t i, T (&field)[3][nodes_per_block],
                 int k) {
  if (from.empty()) return;
  for (int a = 0; a < 3; ++a) field[a][k] = static_cast<T>(from[i][a]);
}

}  // namespace

template <class T>
void load_grid(Simulation<T>& sim, const Grid& grid) {
  NodeStore<T>& nodes = sim.nodes;
  ImplicitMemory<T>& implicit = sim.implicit;
  const bool integrated = written_by_stages(sim).v_new;
  nodes.require_fields();
  for (std::size_t n = 0; n < nodes.size(); ++n) nodes.fields(n) = NodeFields<T>{};
  if (sim.semi_implicit()) implicit.release(nodes.size()), implicit.remember_v_star(nodes);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const auto at = nodes.find(grid.node[i]);
    if (!at.found()) continue;
    NodeFields<T>& node = nodes.fields(at.block);
    if (!grid.m.empty()) node.m[at.node] = static_cast<T>(grid.m[i]);
    set_at_node(grid.v, i, node.v, at.node);
    set_at_node(grid.f, i, node.f, at.node);
    set_at_node(integrated ? grid.v_new : grid.v_star, i, node.v_star, at.node);
    if (!sim.semi_implicit()) continue;
    if (integrated) set_at_node(grid.v_star, i, implicit.v_star[at.block].v, at.node);
    if (!grid.free_directions.empty() && !grid.free_directions[i].isIdentity(0))
      implicit.free.set(at.block, at.node, grid.free_directions[i]);
  }
}

template <class T>
void store_grid(const Simulation<T>& sim, Grid& grid) {
  struct Entry {
    NodeIndex index;
    std::size_t block;
    int node;
  };
  std::vector<Entry> order;
  for (std::size_t n = 0; n < sim.nodes.size(); ++n)
    for (int k = 0; k < nodes_per_block; ++k)
      if (sim.nodes.fields(n).m[k] > 0) order.push_back({sim.nodes.index(n, k), n, k});
  std::sort(order.begin(), order.end(),
            [](const Entry& a, const Entry& b) { return a.index < b.index; });
  const Written written = written_by_stages(sim);
  for (const auto& [index, n, k] : order) {
    const NodeFields<T>& node = sim.nodes.fields(n);
    grid.node.push_back(index);
    grid.m.push_back(static_cast<double>(node.m[k]));
    grid.v.push_back(at_node(node.v, k));
    if (written.forces) grid.f.push_back(at_node(node.f, k));
    // The solve puts v^{n+1} in the place of v*.
    if (written.v_star)
      grid.v_star.push_back(sim.semi_implicit() && written.v_new
                                ? at_node(sim.implicit.v_star[n].v, k)
                                : at_node(node.v_star, k));
    if (written.free_directions) grid.free_directions.push_back(sim.implicit.free.at(n, k));
    if (written.v_new) grid.v_new.push_back(at_node(node.v_star, k));
  }
}

template void load_grid(Simulation<float>&, const Grid&);
template void load_grid(Simulation<double>&, const Grid&);
template void store_grid(const Simulation<float>&, Grid&);
template void store_grid(const Simulation<double>&, Grid&);

}  // namespace firn::optimized
