// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Sums over all particles, block by block on any thread, the blocks' sums added in
/// the order of the blocks: the same bits at any number of threads.

#include "firn/diagnostics.hpp"
#include "optimized/drivers/simulation.hpp"

namespace firn::optimized {

/// Between steps, where the stress is up to date: the energy comes from it.
template <class T>
Diagnostics diagnostics_of(const Simulation<T>& sim);

}  // namespace firn::optimized
