// SPDX-License-Identifier: BSD-3-Clause
#include "reference/grid_nodes.hpp"

#include <algorithm>
#include <string>

#include "firn/error.hpp"
#include "reference/failure.hpp"

namespace firn::reference {

std::int64_t nodes_of_positive_mass(const Grid& grid) {
  return std::count_if(grid.m.begin(), grid.m.end(), [](double m_i) { return m_i > 0; });
}

void drop_massless_nodes(Grid& grid) {
  const std::vector<double> m = grid.m;
  const auto drop = [&](const char*, auto& values) {
    if (values.empty()) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < m.size(); ++i)
      if (m[i] > 0) values[kept++] = values[i];
    values.erase(values.begin() + static_cast<std::ptrdiff_t>(kept), values.end());
  };
  drop("node", grid.node);
  for_each_field(drop, grid);
}

Grid spread_over(const std::vector<NodeIndex>& node, const Grid& grid) {
  std::vector<std::size_t> place;
  std::size_t next = 0;
  for (const NodeIndex& n : grid.node) {
    while (next < node.size() && node[next] < n) ++next;
    if (next == node.size() || !(node[next] == n))
      throw InputError("state", "grid node", to_text(n),
                       "nodes within reach of a particle, sorted by (i, j, k)");
    place.push_back(next);
  }
  Grid result;
  result.node = node;
  for_each_field(
      [&]<class T>(const char*, const std::vector<T>& from, std::vector<T>& to) {
        if (from.empty()) return;
        if (from.size() != place.size())
          throw InputError("state", "values at nodes", std::to_string(from.size()),
                           std::to_string(place.size()) + ", the number of nodes");
        to.assign(node.size(), blank<T>());
        for (std::size_t i = 0; i < place.size(); ++i) to[place[i]] = from[i];
      },
      grid, result);
  return result;
}

double bytes(const Grid& grid) {
  double sum = static_cast<double>(grid.node.capacity() * sizeof(NodeIndex));
  for_each_field(
      [&](const char*, const auto& values) {
        sum += static_cast<double>(values.capacity() * sizeof(values[0]));
      },
      grid);
  return sum;
}

}  // namespace firn::reference
