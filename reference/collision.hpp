// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// One body collision, as steps 5 and 9 apply it.

#include "firn/collider.hpp"

namespace firn::reference {

enum class ContactMode {
  none,    ///< outside, or moving away: the velocity is unchanged
  sticks,  ///< moves with the collider
  slides,  ///< keeps a tangential relative velocity
};

/// Applies `contact` to the velocity v (Stomakhin et al. 2013, section 8):
///
///     v_rel = v − v_co,   v_n = v_rel·n,   v_t = v_rel − n v_n
///     v_n ≥ 0:            no collision
///     ‖v_t‖ ≤ −μ v_n:     v_rel' = 0
///     otherwise:          v_rel' = v_t + μ v_n v_t/‖v_t‖
///     v = v_rel' + v_co
///
/// A sticky collider sets v_rel' = 0 whatever v_n is.
ContactMode collide(const Collider& collider, const Contact& contact, Vec3& v);

}  // namespace firn::reference
