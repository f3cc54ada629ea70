// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// How a step says that it cannot go on.

#include <cstddef>
#include <string>

#include "firn/error.hpp"
#include "firn/state.hpp"

namespace firn::reference {

/// Throws SimulationError naming the stage and the particle.
[[noreturn]] void fail_at_particle(Stage stage, std::size_t p, const std::string& what);

/// Throws SimulationError naming the stage, the node (i,j,k) and its place among
/// the nodes of positive mass.
[[noreturn]] void fail_at_node(Stage stage, const Grid& grid, std::size_t i,
                               const std::string& what);

/// "(i, j, k)"
std::string to_text(const NodeIndex& n);
using firn::to_text;

/// What to say of a particle at x outside the domain of the grid.
std::string outside_domain(const Vec3& x);

/// True where no component is NaN or infinite: x − x is 0 for finite x only.
inline bool finite(double x) { return x - x == 0; }
inline bool finite(const Vec3& v) { return finite(v[0]) && finite(v[1]) && finite(v[2]); }
inline bool finite(const Mat3& m) {
  return finite(Vec3(m.col(0))) && finite(Vec3(m.col(1))) && finite(Vec3(m.col(2)));
}

}  // namespace firn::reference
