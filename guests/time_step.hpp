#pragma once
/// Δt for a guest that cannot choose it.

#include "firn/scene.hpp"
#include "firn/solver.hpp"

namespace firn::guest {

/// The scene's rule applied to these particles: a fixed step, or the smallest of
/// max_step, cfl·h/max‖v_p‖ and (explicit) elastic_cfl·h/max c_p with c_p² =
/// (λ_p + 2μ_p)/ρ_p after hardening. Stomakhin et al. 2013, §4.1; units s.
TimeStep time_step_by_rule(const Scene& scene, const Particles& particles);

}  // namespace firn::guest
