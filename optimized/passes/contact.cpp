// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/passes/contact.hpp"

namespace firn::optimized {

namespace {

/// Takes the direction n out of the space onto which `free` projects. Only the part of n
/// that is still free counts: two colliders need not be orthogonal.
void hold(const Vec3& n, Mat3& free) {
  const Vec3 rest = free * n;
  // Normals that agree to 1e-8, the square root of roundoff, are the same normal.
  if (rest.squaredNorm() <= 1e-16) return;
  free -= rest * rest.transpose() / rest.squaredNorm();
}

}  // namespace

ContactMode collide(const Collider& collider, const Contact& contact, bool skip_friction, Vec3& v) {
  if (collider.sticky) {
    v = contact.velocity;
    return ContactMode::sticks;
  }
  const Vec3 v_rel = v - contact.velocity;
  const double v_n = v_rel.dot(contact.normal);
  if (v_n >= 0) return ContactMode::none;
  const Vec3 v_t = v_rel - v_n * contact.normal;
  if (skip_friction && collider.friction == 0) {
    v = v_t + contact.velocity;
    return v_t == Vec3::Zero() ? ContactMode::sticks : ContactMode::slides;
  }
  const double slip = v_t.norm();
  if (slip <= -collider.friction * v_n) {
    v = contact.velocity;
    return ContactMode::sticks;
  }
  v = (1 + collider.friction * v_n / slip) * v_t + contact.velocity;
  return ContactMode::slides;
}

void Contacts::near(const Vec3& center, double radius, std::vector<std::size_t>& out) const {
  out.clear();
  for (std::size_t k = 0; k < scene_->colliders.size(); ++k) {
    const Collider& collider = scene_->colliders[k];
    // φ itself is rounded: 1e-12 of its size is thousands of times that.
    const double phi = collider.phi(center, time_);
    if (!(phi > lipschitz_bound(collider.shape) * radius + 1e-12 * (std::abs(phi) + center.norm())))
      out.push_back(k);
  }
}

void Contacts::all(std::vector<std::size_t>& out) const {
  out.clear();
  for (std::size_t k = 0; k < scene_->colliders.size(); ++k) out.push_back(k);
}

void Contacts::collide(const std::vector<std::size_t>& colliders, const Vec3& x, Vec3& v) const {
  for (const std::size_t k : colliders) {
    const Collider& collider = scene_->colliders[k];
    if (collider.phi(x, time_) > 0) continue;
    optimized::collide(collider, collider.contact(x, time_), skip_friction_, v);
  }
}

void Contacts::collide(const std::vector<std::size_t>& colliders, const Vec3& x, Vec3& v,
                       Mat3& free) const {
  for (const std::size_t k : colliders) {
    const Collider& collider = scene_->colliders[k];
    if (collider.phi(x, time_) > 0) continue;
    const Contact contact = collider.contact(x, time_);
    const ContactMode mode = optimized::collide(collider, contact, skip_friction_, v);
    if (mode == ContactMode::sticks) free.setZero();
    if (mode == ContactMode::slides) hold(contact.normal, free);
  }
}

}  // namespace firn::optimized
