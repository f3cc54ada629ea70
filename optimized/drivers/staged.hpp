// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The step stage by stage, with the kernels of the fused step and every field kept: for those who
/// look between two stages, and to find out where a number stops being finite.

#include "firn/solver.hpp"
#include "optimized/drivers/simulation.hpp"

namespace firn::optimized {

/// One stage, the one that comes next. Throws SimulationError.
template <class T>
void run_stage(Simulation<T>& sim, Stage stage);

/// Every stage from sim.next up to and including `last`, with time step dt [s]; ends the step if
/// that was stage 10. Throws SimulationError; then the step is over as well.
template <class T>
StepReport run_stages(Simulation<T>& sim, Stage last, double dt);

}  // namespace firn::optimized
