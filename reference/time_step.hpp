// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The scene's rule for Δt.

#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "firn/time_step.hpp"

namespace firn::reference {

/// Δt by the scene's rule (firn/time_step.hpp) and which bound held. The sound speed is that
/// of the hardened snow,
///
///     c_p = √((λ_p + 2μ_p)/ρ_p),   ρ_p = m_p/V_p0      [m/s]
///
/// and concerns explicit integration only. Before step 2 has estimated V_p0,
/// ρ_p is the density of the material. Throws SimulationError for a speed that
/// is not finite.
TimeStep choose_time_step(const Scene& scene, const Particles& particles);

}  // namespace firn::reference
