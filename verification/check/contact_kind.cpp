// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/contact_kind.hpp"

namespace firn::check {

ContactKind contact_kind(const Collider& collider, const Contact& contact, const Vec3& v) {
  if (contact.phi > 0) return ContactKind::none;
  if (collider.sticky) return ContactKind::sticks;
  const Vec3 v_rel = v - contact.velocity;
  const double v_n = v_rel.dot(contact.normal);
  if (v_n >= 0) return ContactKind::separates;
  const double speed = (v_rel - v_n * contact.normal).norm();
  return speed <= -collider.friction * v_n ? ContactKind::sticks : ContactKind::slides;
}

Vec3 respond(const Collider& collider, const Contact& contact, const Vec3& v) {
  const Vec3 v_rel = v - contact.velocity;
  const double v_n = v_rel.dot(contact.normal);
  const Vec3 v_t = v_rel - v_n * contact.normal;
  switch (contact_kind(collider, contact, v)) {
    case ContactKind::none:
    case ContactKind::separates: return v;
    case ContactKind::sticks: return contact.velocity;
    case ContactKind::slides: break;
  }
  return (1 + collider.friction * v_n / v_t.norm()) * v_t + contact.velocity;
}

}  // namespace firn::check
