// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Between the solver's grid, which has every node within reach of a particle,
/// and that of a State, which has the nodes of positive mass.

#include <cstdint>
#include <vector>

#include "firn/state.hpp"

namespace firn::reference {

std::int64_t nodes_of_positive_mass(const Grid& grid);

/// Removes the nodes of zero mass.
void drop_massless_nodes(Grid& grid);

/// `grid` on the sorted nodes `node`, zero where it says nothing. Throws
/// InputError if `grid` is not sorted or has a node that is not among them.
Grid spread_over(const std::vector<NodeIndex>& node, const Grid& grid);

/// Memory held [B].
double bytes(const Grid& grid);

}  // namespace firn::reference
