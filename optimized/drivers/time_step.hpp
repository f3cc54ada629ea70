// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Δt by the scene's rule.

#include "firn/solver.hpp"
#include "optimized/drivers/simulation.hpp"

namespace firn::optimized {

/// Throws SimulationError, with the state intact, if a particle's speed or sound speed is not
/// finite.
template <class T>
TimeStep choose_time_step(Simulation<T>& sim);

}  // namespace firn::optimized
