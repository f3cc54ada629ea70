// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The fields of the nodes of positive mass, from and to a State between two stages.

#include "firn/state.hpp"
#include "optimized/drivers/simulation.hpp"

namespace firn::optimized {

/// Into the node fields that are kept. Nodes out of every particle's reach are left out: they have
/// no influence.
template <class T>
void load_grid(Simulation<T>& sim, const Grid& grid);

/// Appended to an empty grid, in (i,j,k) order; arrays that no stage has written stay empty.
template <class T>
void store_grid(const Simulation<T>& sim, Grid& grid);

}  // namespace firn::optimized
