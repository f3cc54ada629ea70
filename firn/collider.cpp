#include "firn/collider.hpp"

#include <Eigen/Geometry>

namespace firn {

namespace {

Mat3 rotation_at(const Vec3& angular_velocity, double t) {
  const double speed = angular_velocity.norm();
  if (speed == 0 || t == 0) return Mat3::Identity();
  return Eigen::AngleAxisd(speed * t, angular_velocity / speed).toRotationMatrix();
}

}  // namespace

Vec3 Collider::to_shape_frame(const Vec3& x, double t) const {
  if (!moves()) return x;
  const Vec3 from_center = x - (center + t * velocity);
  return center + rotation_at(angular_velocity, t).transpose() * from_center;
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
    contact.normal = rotation_at(angular_velocity, t) * contact.normal;
    contact.velocity = velocity + angular_velocity.cross(x - (center + t * velocity));
  }
  return contact;
}

}  // namespace firn
