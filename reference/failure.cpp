// SPDX-License-Identifier: BSD-3-Clause
#include "reference/failure.hpp"

#include <algorithm>

namespace firn::reference {

void fail_at_particle(Stage stage, std::size_t p, const std::string& what) {
  throw SimulationError(stage, SimulationError::Subject::particle, static_cast<std::int64_t>(p),
                        what);
}

std::string to_text(const NodeIndex& n) {
  std::string text = "(";
  text += std::to_string(n.i) + ", ";
  text += std::to_string(n.j) + ", ";
  text += std::to_string(n.k) + ")";
  return text;
}

std::string outside_domain(const Vec3& x) {
  return "position (" + to_text(x[0]) + ", " + to_text(x[1]) + ", " + to_text(x[2]) +
         ") is outside the representable domain of 2^30 cells about the origin";
}

void fail_at_node(Stage stage, const Grid& grid, std::size_t i, const std::string& what) {
  const auto end = grid.m.begin() + static_cast<std::ptrdiff_t>(i);
  const auto place = std::count_if(grid.m.begin(), end, [](double m_i) { return m_i > 0; });
  throw SimulationError(stage, SimulationError::Subject::node, place,
                        what + " at node " + to_text(grid.node[i]));
}

}  // namespace firn::reference
