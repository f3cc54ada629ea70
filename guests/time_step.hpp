// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Δt for a guest that cannot choose it.

#include "firn/state.hpp"
#include "firn/time_step.hpp"

namespace firn::guest {

/// The scene's rule (firn/time_step.hpp) for these particles, with c_p² = (λ_p + 2μ_p)/ρ_p
/// after hardening.
TimeStep choose_time_step(const Scene& scene, const Particles& particles);

}  // namespace firn::guest
