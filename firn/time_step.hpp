// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The scene's rule for Δt. A solver finds its largest particle speed and sound speed;
/// this function turns them into Δt.

#include <string_view>

#include "firn/scene.hpp"

namespace firn {

/// Which limit decided Δt.
enum class TimeStepBound { fixed, max_step, cfl, elastic_cfl };
std::string_view name(TimeStepBound bound);

struct TimeStep {
  double dt = 0;  ///< [s]
  TimeStepBound bound = TimeStepBound::fixed;
};

/// The fixed step of the scene or, where it is adaptive, the smallest of max_step,
/// cfl·h/max‖v_p‖ and, in explicit scenes, elastic_cfl·h/max c_p. The latter two are
/// given in m/s; c_p = √((λ_p + 2μ_p)/ρ_p) with the hardened moduli and ρ_p = m_p/V_p0,
/// or the material's density before V_p0 is known.
TimeStep time_step_by_rule(const Scene& scene, double fastest_particle, double fastest_sound);

}  // namespace firn
