// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// From node blocks to particles: stages 7 to 10 over all blocks.

#include <vector>

#include "optimized/drivers/simulation.hpp"

namespace firn::optimized {

/// Stages 7, 8 and 10 as `passes` says (values of Pass, combined by |), and stage 9 if `collide`.
/// Particles that leave their block are taken out of it; put_in() of the store must follow. Throws
/// SimulationError for the first particle whose values are not finite or that moves too far.
template <class T>
void update_particles(Simulation<T>& sim, int passes, bool collide);

}  // namespace firn::optimized
