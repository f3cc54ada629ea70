// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A solid of prescribed motion.

#include "firn/shape.hpp"
#include "firn/types.hpp"

namespace firn {

/// What a collision test needs to know at one point (step 5 of the method).
struct Contact {
  double phi = 0;                ///< signed distance, ≤ 0 inside [m]
  Vec3 normal = Vec3::UnitZ();   ///< n, unit outward normal
  Vec3 velocity = Vec3::Zero();  ///< v_co, the collider's velocity at that point [m/s]
};

/// Shape moving rigidly: x(t) = c + t·velocity + R(t)(X − c), where c is
/// `center` at t = 0 and R(t) turns by |ω|t about ω.
struct Collider {
  Shape shape;
  bool inside = false;                   ///< turned inside out: a container
  double friction = 0;                   ///< Coulomb μ [1], ≥ 0
  bool sticky = false;                   ///< v_rel' = 0 whatever v_n
  Vec3 velocity = Vec3::Zero();          ///< [m/s]
  Vec3 angular_velocity = Vec3::Zero();  ///< ω [rad/s]
  Vec3 center = Vec3::Zero();            ///< c [m]

  bool moves() const { return !velocity.isZero(0) || !angular_velocity.isZero(0); }

  /// φ at x and time t [m].
  double phi(const Vec3& x, double t) const;

  /// φ, n and v_co = velocity + ω × (x − c(t)) at x and time t.
  Contact contact(const Vec3& x, double t) const;

  /// R(t), a rotation matrix. The same bits from every compiler and C library.
  Mat3 rotation(double t) const;

  /// c(t) = center + t·velocity [m].
  Vec3 center_at(double t) const { return center + t * velocity; }

  /// A point fixed in space seen from the shape's own frame at time t.
  Vec3 to_shape_frame(const Vec3& x, double t) const;
};

}  // namespace firn
