// SPDX-License-Identifier: BSD-3-Clause
#include "firn/shape.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "firn/sampled_distance.hpp"

namespace firn {

namespace {

/// d/‖d‖, or `fallback` for d = 0. Scaled first, so that no d underflows.
Vec3 unit(const Vec3& d, const Vec3& fallback) {
  const double largest = d.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return fallback;
  return (d / largest).normalized();
}

/// A unit vector at right angles to the unit vector a.
Vec3 perpendicular(const Vec3& a) {
  int smallest = 0;
  a.cwiseAbs().minCoeff(&smallest);
  return a.cross(Vec3::Unit(smallest)).normalized();
}

/// The rule for points exactly on a surface: of two faces that differ only in
/// direction, the one that faces the smaller coordinates belongs to the solid.
bool faces_minimum(const Vec3& normal) {
  for (int axis = 0; axis < 3; ++axis)
    if (normal[axis] != 0) return normal[axis] < 0;
  return false;
}

// Sphere ------------------------------------------------------------------

double distance(const Sphere& s, const Vec3& x) { return (x - s.center).norm() - s.radius; }

Vec3 normal(const Sphere& s, const Vec3& x) { return unit(x - s.center, Vec3::UnitZ()); }

bool holds(const Sphere& s, const Vec3& x) {
  const double phi = distance(s, x);
  return phi < 0 || (phi == 0 && faces_minimum(normal(s, x)));
}

Bounds solid_bounds(const Sphere& s) {
  return {s.center - Vec3::Constant(s.radius), s.center + Vec3::Constant(s.radius)};
}

// Box: distances beyond the nearer of the two faces, per axis ----------------

Vec3 beyond_faces(const Box& b, const Vec3& x) { return (b.min - x).cwiseMax(x - b.max); }

double distance(const Box& b, const Vec3& x) {
  const Vec3 beyond = beyond_faces(b, x);
  const double nearest_face = beyond.maxCoeff();
  return nearest_face <= 0 ? nearest_face : beyond.cwiseMax(0.0).norm();
}

Vec3 normal(const Box& b, const Vec3& x) {
  const Vec3 beyond = beyond_faces(b, x);
  Vec3 outward;
  for (int axis = 0; axis < 3; ++axis)
    outward[axis] = x[axis] - b.max[axis] >= b.min[axis] - x[axis] ? 1 : -1;
  const double nearest_face = beyond.maxCoeff();
  if (nearest_face <= 0) {
    // Where several faces are equally near the normal is their mean: the choice of one would
    // make a symmetric edge deflect to one side.
    const Vec3 nearest = (beyond.array() == nearest_face).cast<double>();
    return nearest.cwiseProduct(outward).normalized();
  }
  return unit(beyond.cwiseMax(0.0).cwiseProduct(outward), Vec3::UnitZ());
}

bool holds(const Box& b, const Vec3& x) {
  return (x.array() >= b.min.array()).all() && (x.array() < b.max.array()).all();
}

Bounds solid_bounds(const Box& b) { return {b.min, b.max}; }

// Cylinder: a box in the plane of (radial, axial) ----------------------------

struct CylinderPlace {
  Vec3 axial, radial;              // outward unit vectors towards the nearer cap and the side
  double beyond_cap, beyond_side;  // distances beyond these faces
};

CylinderPlace place(const Cylinder& c, const Vec3& x) {
  const Vec3 axis = unit(c.axis, Vec3::UnitZ());
  const Vec3 d = x - c.center;
  const double along = d.dot(axis);
  const Vec3 across = d - along * axis;
  return {along >= 0 ? axis : Vec3(-axis), unit(across, perpendicular(axis)),
          std::abs(along) - c.height / 2, across.norm() - c.radius};
}

double distance(const Cylinder& c, const Vec3& x) {
  const CylinderPlace p = place(c, x);
  if (p.beyond_cap <= 0 || p.beyond_side <= 0) return std::max(p.beyond_cap, p.beyond_side);
  return std::sqrt(p.beyond_cap * p.beyond_cap + p.beyond_side * p.beyond_side);
}

Vec3 normal(const Cylinder& c, const Vec3& x) {
  const CylinderPlace p = place(c, x);
  if (p.beyond_cap <= 0 || p.beyond_side <= 0) {
    if (p.beyond_side == p.beyond_cap) return (p.axial + p.radial).normalized();
    return p.beyond_side > p.beyond_cap ? p.radial : p.axial;
  }
  return unit(p.beyond_cap * p.axial + p.beyond_side * p.radial, p.radial);
}

bool holds(const Cylinder& c, const Vec3& x) {
  const CylinderPlace p = place(c, x);
  return (p.beyond_cap < 0 || (p.beyond_cap == 0 && faces_minimum(p.axial))) &&
         (p.beyond_side < 0 || (p.beyond_side == 0 && faces_minimum(p.radial)));
}

Bounds solid_bounds(const Cylinder& c) {
  const Vec3 axis = unit(c.axis, Vec3::UnitZ());
  Vec3 reach;
  for (int a = 0; a < 3; ++a)
    reach[a] = std::abs(axis[a]) * c.height / 2 +
               c.radius * std::sqrt(std::max(0.0, 1 - axis[a] * axis[a]));
  return {c.center - reach, c.center + reach};
}

// Half-space ------------------------------------------------------------------

Vec3 normal(const HalfSpace& s, const Vec3&) { return unit(s.normal, Vec3::UnitZ()); }

double distance(const HalfSpace& s, const Vec3& x) { return normal(s, x).dot(x - s.point); }

bool holds(const HalfSpace& s, const Vec3& x) {
  const double phi = distance(s, x);
  return phi < 0 || (phi == 0 && faces_minimum(s.normal));
}

std::optional<Bounds> solid_bounds(const HalfSpace&) { return std::nullopt; }

// Sampled -----------------------------------------------------------------------

double distance(const SampledShape& s, const Vec3& x) { return s.distance->distance(x); }

Vec3 normal(const SampledShape& s, const Vec3& x) {
  return unit(s.distance->gradient(x), Vec3::UnitZ());
}

bool holds(const SampledShape& s, const Vec3& x) {
  const double phi = distance(s, x);
  return phi < 0 || (phi == 0 && faces_minimum(normal(s, x)));
}

Bounds solid_bounds(const SampledShape& s) { return s.distance->solid_bounds(); }

// Solid -------------------------------------------------------------------------

double distance(const SolidShape& s, const Vec3& x) { return s.solid->distance(x); }

Vec3 normal(const SolidShape& s, const Vec3& x) { return s.solid->normal(x); }

bool holds(const SolidShape& s, const Vec3& x) { return s.solid->contains(x); }

Bounds solid_bounds(const SolidShape& s) { return s.solid->bounds(); }

}  // namespace

double signed_distance(const Shape& shape, const Vec3& x) {
  return std::visit([&](const auto& s) { return distance(s, x); }, shape);
}

Vec3 outward_normal(const Shape& shape, const Vec3& x) {
  return std::visit([&](const auto& s) { return normal(s, x); }, shape);
}

bool contains(const Shape& shape, const Vec3& x) {
  return std::visit([&](const auto& s) { return holds(s, x); }, shape);
}

std::optional<Bounds> bounds(const Shape& shape) {
  return std::visit([](const auto& s) { return std::optional<Bounds>(solid_bounds(s)); }, shape);
}

Vec3 center(const Shape& shape) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return s->center;
  if (const auto* c = std::get_if<Cylinder>(&shape)) return c->center;
  if (const auto* s = std::get_if<HalfSpace>(&shape)) return s->point;
  const Bounds b = *bounds(shape);
  return b.min + 0.5 * (b.max - b.min);
}

double lipschitz_bound(const Shape& shape) {
  if (const auto* s = std::get_if<SampledShape>(&shape)) return s->distance->lipschitz_bound();
  return 1.0;
}

}  // namespace firn
