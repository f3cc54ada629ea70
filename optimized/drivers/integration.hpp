// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Step 6 of semi-implicit scenes.

#include "optimized/drivers/simulation.hpp"

namespace firn::optimized {

/// v_i^{n+1} from (M + βΔt²H) v = M v* along the directions that contact leaves free, in
/// sim.implicit.motion, whose v* it replaces. Tiles and what stages 7 and 8 gather lose what they
/// hold. Throws SimulationError if the solve does not reach its tolerance; the state is intact.
template <class T>
void solve_implicit(Simulation<T>& sim);

/// The same from the node fields that are kept, and back.
template <class T>
void solve_kept_fields(Simulation<T>& sim);

}  // namespace firn::optimized
