// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What a solver that takes whole steps alone chose at the nodes whose contact is in doubt,
/// read off its particles.

#include "verification/check/contact_path.hpp"

namespace firn::check {

/// `own` is the reference's path through `positions` with its own choices, `before` the
/// particles at the start of the step, `subject` the solver's state after it. Explicit scenes
/// only: there v_p and F are linear in v_i*, so that another outcome at node i, different by
/// d_i, moves v_p by w_ip d_i and F by Δt d_i (∇w_ip)ᵀ Fⁿ. Least squares in units of the
/// bounds; −1 where the particles do not determine a node.
Choices inferred_choices(const Scene& scene, const Fork& fork, const Path& own,
                         const Particles& before, const Particles& subject, double dt);

}  // namespace firn::check
