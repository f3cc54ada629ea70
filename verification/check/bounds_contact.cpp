// SPDX-License-Identifier: BSD-3-Clause
/// Error bounds of steps 5 and 9: contact.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "verification/check/bounds.hpp"
#include "verification/check/contact_kind.hpp"

namespace firn::check {

namespace {

/// How uncertain the argument of φ, n and v_co is [m]: the point itself and the
/// few operations that take it into the collider's frame, turned by ωt about a
/// centre that has moved by Vt, against the numbers that describe the shape.
Vec3 query_error(const Collider& collider, const Vec3& x, const Vec3& x_error, double time,
                 double eps) {
  const Vec3 center = collider.center + time * collider.velocity;
  const double angle = std::abs(time) * collider.angular_velocity.norm();
  const double size = x.norm() + collider.center.norm() + firn::center(collider.shape).norm() +
                      std::abs(time) * collider.velocity.norm() + (1 + angle) * (x - center).norm();
  return x_error + Vec3::Constant(4 * eps * size);
}

/// Is the projector that step 5 hands to the implicit solve in doubt? It jumps at
/// v_n = 0 and where sticking turns into sliding.
bool projector_in_doubt(const Collider& collider, const Contact& contact, const Vec3& v,
                        double error) {
  if (collider.sticky) return false;
  const Vec3 v_rel = v - contact.velocity;
  const double v_n = v_rel.dot(contact.normal);
  const double v_t = (v_rel - v_n * contact.normal).norm();
  return std::abs(v_n) <= error ||
         std::abs(v_t + collider.friction * v_n) <= (1 + collider.friction) * error;
}

}  // namespace

/// φ, n and v_co are conditioned by the collider's shape: near the edge of a box, the
/// centre of a sphere or a crease of a level set they turn over within a hair. So
/// their sensitivity is measured, by asking the collider at six points displaced by
/// the query's own error. Where the sign of φ is in doubt, contact is discontinuous:
/// both answers are right, and the bound is their distance.
///
/// For a fixed contact the response is Lipschitz: sliding maps (v_t, v_n) to
/// v_t + μ v_n v_t/‖v_t‖, which contracts in v_t as long as it slides and depends on
/// v_n with slope μ; it is continuous at v_n = 0 and at the friction cone.
ContactBounds contact_bounds(const Scene& scene, const Vec3& x, const Vec3& x_error,
                             const Vec3& v_before, double error, double time, double eps) {
  ContactBounds bounds{error, 0};
  Vec3 v = v_before;
  int touching = 0;
  for (const Collider& collider : scene.colliders) {
    const Vec3 delta = query_error(collider, x, x_error, time, eps);
    const double phi_here = collider.phi(x, time);
    if (phi_here > 2 * std::sqrt(3.0) * lipschitz_bound(collider.shape) * delta.maxCoeff())
      continue;
    Contact here = collider.contact(x, time);
    const Vec3 after = respond(collider, here, v);
    double spread = 0, n_error = 0, v_co_error = 0;
    bool phi_in_doubt = false;
    for (int probe = 0; probe < 6; ++probe) {
      Vec3 displaced = x;
      displaced[probe / 2] += probe % 2 == 0 ? delta[probe / 2] : -delta[probe / 2];
      const Contact there = collider.contact(displaced, time);
      phi_in_doubt = phi_in_doubt || (there.phi <= 0) != (here.phi <= 0);
      spread = std::max(spread, (respond(collider, there, v) - after).norm());
      n_error = std::max(n_error, (there.normal - here.normal).norm());
      v_co_error = std::max(v_co_error, (there.velocity - here.velocity).norm());
    }
    // One probe per axis; an error may point along all three.
    spread *= std::sqrt(3.0);
    n_error *= std::sqrt(3.0);
    v_co_error *= std::sqrt(3.0);
    const double speed = v.norm() + here.velocity.norm();
    // The other side of φ = 0 as well, in case no probe crossed an in-doubt surface.
    if (phi_in_doubt || std::abs(here.phi) <= lipschitz_bound(collider.shape) * delta.maxCoeff()) {
      phi_in_doubt = true;
      Contact other = here;
      other.phi = here.phi > 0 ? 0.0 : 1.0;
      spread = std::max(spread, (respond(collider, other, v) - after).norm());
    }
    const double doubt =
        bounds.v + n_error * speed + v_co_error + Roundoff::collision * eps * speed;
    if (phi_in_doubt || (here.phi <= 0 && projector_in_doubt(collider, here, v, doubt)))
      bounds.free_directions = unbounded;
    if (here.phi <= 0 || phi_in_doubt) {
      if (here.phi <= 0) ++touching;
      const double lipschitz = collider.sticky && !phi_in_doubt ? 0 : 1 + collider.friction;
      bounds.v = lipschitz * bounds.v + spread + v_co_error +
                 Roundoff::collision * eps * (1 + collider.friction) * speed;
      bounds.free_directions += 2 * n_error + Roundoff::few * eps;
    }
    v = after;
  }
  // Two normals span a plane whose projector is conditioned by the angle between
  // them, which is not known here.
  if (touching > 1) bounds.free_directions = unbounded;
  return bounds;
}

void BoundModel::grid_collisions(const State& before, const State& after) {
  const Grid& grid = before.grid;
  const double h = scene_.grid.spacing;
  bounds_.free_directions.assign(after.grid.free_directions.size(), 0);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec3 ijk(grid.node[i].i, grid.node[i].j, grid.node[i].k);
    const Vec3 x = scene_.grid.origin + h * ijk;
    const Vec3 x_error = 2 * r_.eps * (scene_.grid.origin.cwiseAbs() + h * ijk.cwiseAbs());
    const ContactBounds contact =
        contact_bounds(scene_, x, x_error, grid.v_star[i], bounds_.v_star[i], before.time, r_.eps);
    bounds_.v_star[i] = contact.v;
    if (!bounds_.free_directions.empty()) bounds_.free_directions[i] = contact.free_directions;
  }
}

void BoundModel::particle_collisions(const State& before) {
  const Particles& p = before.particles;
  for (std::size_t q = 0; q < p.size(); ++q)
    bounds_.v[q] =
        contact_bounds(scene_, p.x[q], bounds_.x[q], p.v[q], bounds_.v[q], before.time, r_.eps).v;
}

}  // namespace firn::check
