// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What every step begins and ends with, whichever driver runs it.

#include "firn/solver.hpp"
#include "optimized/drivers/simulation.hpp"

namespace firn::optimized {

/// Constants, contacts and scratch memory for a step of dt [s] from the present time on.
template <class T>
void begin_step(Simulation<T>& sim, double dt);

/// Stress and stiffness of every particle from its F_E, F_P and V_p0, if they are out of date.
template <class T>
void refresh_stress(Simulation<T>& sim);

/// The report of the stages that have run, on `grid_nodes` nodes of positive mass.
template <class T>
StepReport report_of(const Simulation<T>& sim, std::int64_t grid_nodes);

/// Time and step count after stage 10.
template <class T>
void finish_step(Simulation<T>& sim);

}  // namespace firn::optimized
