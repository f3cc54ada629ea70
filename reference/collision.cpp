// SPDX-License-Identifier: BSD-3-Clause
#include "reference/collision.hpp"

namespace firn::reference {

ContactMode collide(const Collider& collider, const Contact& contact, Vec3& v) {
  if (contact.phi > 0) return ContactMode::none;
  const Vec3& n = contact.normal;
  const double mu = collider.friction;
  const Vec3 v_rel = v - contact.velocity;
  const double v_n = v_rel.dot(n);
  if (collider.sticky) {
    v = contact.velocity;
    return ContactMode::sticks;
  }
  if (v_n >= 0) return ContactMode::none;

  const Vec3 v_t = v_rel - n * v_n;
  const double speed_t = v_t.norm();
  if (speed_t <= -mu * v_n) {
    v = contact.velocity;
    return ContactMode::sticks;
  }
  v = (1 + mu * v_n / speed_t) * v_t + contact.velocity;
  return ContactMode::slides;
}

}  // namespace firn::reference
