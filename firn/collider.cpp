// SPDX-License-Identifier: BSD-3-Clause
#include "firn/collider.hpp"

#include <Eigen/Geometry>

#include "firn/rotation.hpp"

namespace firn {

Mat3 Collider::rotation(double t) const {
  const double speed = angular_velocity.norm();
  if (speed == 0 || t == 0) return Mat3::Identity();
  return rotation_about(angular_velocity / speed, speed * t);
}

Vec3 Collider::to_shape_frame(const Vec3& x, double t) const {
  if (!moves()) return x;
  return center + rotation(t).transpose() * (x - center_at(t));
}

double Collider::phi(const Vec3& x, double t) const {
  const double distance = signed_distance(shape, to_shape_frame(x, t));
  return inside ? -distance : distance;
}

Contact Collider::contact(const Vec3& x, double t) const {
  const Vec3 X = to_shape_frame(x, t);
  const double sign = inside ? -1.0 : 1.0;
  Contact contact;
  contact.phi = sign * signed_distance(shape, X);
  contact.normal = sign * outward_normal(shape, X);
  if (moves()) {
    contact.normal = rotation(t) * contact.normal;
    contact.velocity = velocity + angular_velocity.cross(x - center_at(t));
  }
  return contact;
}

}  // namespace firn
