// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The whole step in three passes: particles to tiles, tiles to nodes, nodes to
/// particles. Node fields live in a thread's own memory for one node block at a time; a
/// semi-implicit step keeps m, vⁿ and v* of all of them for its solve.

#include "firn/solver.hpp"
#include "optimized/drivers/simulation.hpp"

namespace firn::optimized {

/// A step of dt [s] from sim.next = rasterize, all volumes known: bit for bit the ten stages.
/// Throws SimulationError; if the state is intact, it names the stage at fault.
template <class T>
StepReport fused_step(Simulation<T>& sim, double dt);

}  // namespace firn::optimized
