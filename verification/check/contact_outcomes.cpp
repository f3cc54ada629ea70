// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/contact_outcomes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "verification/check/cause.hpp"
#include "verification/check/contact_kind.hpp"
#include "verification/check/roundoff.hpp"

namespace firn::check {

namespace {

/// Beyond this many ways nothing is said about the point: six surfaces through one node.
constexpr std::size_t largest_number_of_outcomes = 64;

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

/// What a contact may be: one direction of the normal, and how far rounding moves it.
struct Variant {
  Contact contact;              ///< φ ≤ 0, as if it touches
  std::vector<Contact> others;  ///< as seen from displaced points
  double n_error = 0, v_co_error = 0;
};

/// One collider seen from a point.
struct Surroundings {
  std::vector<Variant> variants;  ///< the first is the point's own
  bool touches = false;           ///< in the reference
  bool in_doubt = false;          ///< whether it touches
};

/// Two or three faces of a shape that meet have so many normals within a hair of the edge.
/// Where there are more, as in the centre of a sphere, the normal may be anything.
constexpr std::size_t largest_number_of_normals = 3;

/// φ, n and v_co are conditioned by the collider's shape: near the edge of a box, the
/// centre of a sphere or a crease of a level set they turn over within a hair. So
/// their sensitivity is measured, by asking at six points displaced by the query's own error.
Surroundings look_around(const Collider& collider, const Vec3& x, const Vec3& delta, double time) {
  Surroundings s;
  const Contact here = collider.contact(x, time);
  s.touches = here.phi <= 0;
  // One probe per axis; an error may point along all three.
  const double all_axes = std::sqrt(3.0);
  s.in_doubt = std::abs(here.phi) <= all_axes * lipschitz_bound(collider.shape) * delta.maxCoeff();
  std::array<Contact, 6> there;
  for (std::size_t probe = 0; probe < 6; ++probe) {
    const auto axis = static_cast<Eigen::Index>(probe / 2);
    Vec3 displaced = x;
    displaced[axis] += probe % 2 == 0 ? delta[axis] : -delta[axis];
    there[probe] = collider.contact(displaced, time);
    s.in_doubt = s.in_doubt || (there[probe].phi <= 0) != s.touches;
  }
  const auto start = [&](Contact contact) {
    contact.phi = std::min(contact.phi, 0.0);
    s.variants.push_back({contact, {}, 0, 0});
  };
  const auto join = [&](Variant& variant, Contact contact) {
    contact.phi = std::min(contact.phi, 0.0);
    variant.others.push_back(contact);
    variant.n_error =
        std::max(variant.n_error, all_axes * (contact.normal - variant.contact.normal).norm());
    variant.v_co_error = std::max(variant.v_co_error,
                                  all_axes * (contact.velocity - variant.contact.velocity).norm());
  };
  start(here);
  for (const Contact& contact : there) {
    const auto alike = [&](const Variant& variant) {
      return (contact.normal - variant.contact.normal).norm() <= widest_judged;
    };
    const auto variant = std::find_if(s.variants.begin(), s.variants.end(), alike);
    if (variant == s.variants.end())
      start(contact);
    else
      join(*variant, contact);
  }
  if (s.variants.size() > largest_number_of_normals) {
    s.variants.resize(1);
    s.variants[0].others.clear();
    for (const Contact& contact : there) join(s.variants[0], contact);
  }
  return s;
}

/// The projector when a contact of this kind is added. Normals of two colliders span a plane
/// whose projector is conditioned by the sine of the angle between them.
void hold(ContactKind kind, const Vec3& normal, double normal_error, ContactOutcome& o) {
  if (kind == ContactKind::sticks) {
    o.free.setZero();
    o.free_error = 0;
  } else if (kind == ContactKind::slides) {
    const Vec3 rest = o.free * normal;
    const double error = normal_error + o.free_error;
    const double sine = rest.norm();
    // Nothing is left of the normal: it is one of those held already, or all are held.
    if (sine > 1e-8) o.free -= rest * rest.transpose() / (sine * sine);
    if (o.free.isZero(0)) return;
    o.free_error = error >= 0.5 * sine ? unbounded : o.free_error + error / sine;
  }
}

/// Kinds of contact that rounding may turn this one into, its own first. The velocity is
/// continuous between them, the projector is not.
std::vector<ContactKind> possible_kinds(const Collider& collider, const Contact& contact,
                                        const Vec3& v, double error) {
  std::vector<ContactKind> kinds{contact_kind(collider, contact, v)};
  if (collider.sticky) return kinds;
  const Vec3 v_rel = v - contact.velocity;
  const double v_n = v_rel.dot(contact.normal);
  const double v_t = (v_rel - v_n * contact.normal).norm();
  const double beyond_cone = v_t + collider.friction * v_n;
  const double cone_error = (1 + collider.friction) * error;
  const auto add = [&](ContactKind kind, bool possible) {
    if (possible && kind != kinds.front()) kinds.push_back(kind);
  };
  add(ContactKind::separates, v_n >= -error);
  add(ContactKind::sticks, v_n <= error && beyond_cone <= cone_error);
  add(ContactKind::slides, v_n <= error && beyond_cone >= -cone_error);
  return kinds;
}

/// The same velocity to within the bounds and, where it counts, the same projector.
bool same(const ContactOutcome& a, const ContactOutcome& b, bool projectors) {
  return (a.v - b.v).norm() <= a.v_error + b.v_error &&
         (!projectors || (a.free - b.free).norm() <= a.free_error + b.free_error);
}

void add_distinct(std::vector<ContactOutcome>& all, const ContactOutcome& more, bool projectors) {
  for (ContactOutcome& o : all)
    if (same(o, more, projectors)) {
      o.v_error = std::max(o.v_error, (o.v - more.v).norm() + more.v_error);
      return;
    }
  all.push_back(more);
}

}  // namespace

/// For a fixed contact the response is Lipschitz: sliding maps (v_t, v_n) to
/// v_t + μ v_n v_t/‖v_t‖, which contracts in v_t as long as it slides and depends on
/// v_n with slope μ; it is continuous at v_n = 0 and at the friction cone.
ContactOutcomes contact_outcomes(const Scene& scene, const ContactPoint& point, double time,
                                 double eps, bool projectors) {
  ContactOutcomes result;
  std::vector<ContactOutcome>& all = result.outcomes;
  all = {{point.v, point.v_error, Mat3::Identity(), 0}};
  for (std::size_t c = 0; c < scene.colliders.size(); ++c) {
    const Collider& collider = scene.colliders[c];
    const Vec3 delta = query_error(collider, point.x, point.x_error, time, eps);
    if (collider.phi(point.x, time) >
        2 * std::sqrt(3.0) * lipschitz_bound(collider.shape) * delta.maxCoeff())
      continue;
    const Surroundings s = look_around(collider, point.x, delta, time);
    if (!s.touches && !s.in_doubt) continue;

    const auto touching = [&](const ContactOutcome& o, std::vector<ContactOutcome>& out) {
      for (const Variant& variant : s.variants) {
        const Contact& contact = variant.contact;
        const Vec3 after = respond(collider, contact, o.v);
        double spread = 0;
        for (const Contact& other : variant.others)
          spread =
              std::max(spread, std::sqrt(3.0) * (respond(collider, other, o.v) - after).norm());
        if (result.normal < 0 && variant.n_error > widest_judged)
          result.normal = static_cast<int>(c);
        const double speed = o.v.norm() + contact.velocity.norm();
        ContactOutcome touched = o;
        touched.v = after;
        touched.v_error = (collider.sticky ? 0 : 1 + collider.friction) * o.v_error + spread +
                          variant.v_co_error +
                          Roundoff::collision * eps * (1 + collider.friction) * speed;
        std::vector<ContactKind> kinds{contact_kind(collider, contact, o.v)};
        if (projectors)
          kinds = possible_kinds(collider, contact, o.v,
                                 o.v_error + variant.n_error * speed + variant.v_co_error +
                                     Roundoff::collision * eps * speed);
        for (const ContactKind kind : kinds) {
          ContactOutcome held = touched;
          hold(kind, contact.normal, 2 * variant.n_error + Roundoff::few * eps, held);
          out.push_back(held);
        }
      }
    };
    std::vector<ContactOutcome> next;
    for (const ContactOutcome& o : all) {
      if (s.touches) touching(o, next);
      if (!s.touches || s.in_doubt) next.push_back(o);
      if (!s.touches) touching(o, next);
    }
    all.clear();
    for (const ContactOutcome& o : next) add_distinct(all, o, projectors);
    if (result.doubtful < 0 && all.size() > 1) result.doubtful = static_cast<int>(c);
    if (all.size() > largest_number_of_outcomes) {
      all.resize(1);
      all[0].v_error = all[0].free_error = unbounded;
      return result;
    }
  }
  return result;
}

}  // namespace firn::check
