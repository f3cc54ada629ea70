// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Stage 2: volumes from the density of the grid.

#include "optimized/drivers/simulation.hpp"

namespace firn::optimized {

/// V_p0 = m_p/ρ_p0 where V_p0 is not known; nothing to do once all are. Reads the masses of the
/// node fields that are kept. Stress and tiles are out of date where it has estimated any.
template <class T>
void estimate_volumes(Simulation<T>& sim);

}  // namespace firn::optimized
