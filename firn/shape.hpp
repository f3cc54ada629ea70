// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Shapes as signed distances: bodies are sampled inside them, colliders push
/// particles out of them.

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "firn/types.hpp"

namespace firn {

class SampledDistance;

struct Sphere {
  Vec3 center = Vec3::Zero();
  double radius = 0;
};

struct Box {
  Vec3 min = Vec3::Zero();
  Vec3 max = Vec3::Zero();
};

struct Cylinder {
  Vec3 center = Vec3::Zero();  ///< centre of the solid
  Vec3 axis = Vec3::UnitZ();   ///< any length > 0
  double radius = 0;
  double height = 0;
};

struct HalfSpace {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< any length > 0; solid on the opposite side
};

/// A closed triangle mesh or a level-set file, held as distances on a grid: what colliders use.
struct SampledShape {
  std::shared_ptr<const SampledDistance> distance;
  std::string source = {};  ///< as a scene file writes the shape; empty if it came from no file
};

struct Bounds {
  Vec3 min, max;
};

/// A bounded solid whose every point is known without samples: what bodies are filled from.
class Solid {
 public:
  virtual ~Solid() = default;

  /// Membership; on faces along the axes the rule of contains(Shape) below.
  virtual bool contains(const Vec3& x) const = 0;

  /// φ(x), negative inside [m].
  virtual double distance(const Vec3& x) const = 0;

  /// Unit vector along ∇φ.
  virtual Vec3 normal(const Vec3& x) const = 0;

  virtual Bounds bounds() const = 0;

  /// Enclosed volume, unless parts overlap [m³].
  virtual std::optional<double> volume() const = 0;
};

/// A closed triangle mesh, exactly.
struct SolidShape {
  std::shared_ptr<const Solid> solid;
  std::string source = {};  ///< as in SampledShape
};

using Shape = std::variant<Sphere, Box, Cylinder, HalfSpace, SampledShape, SolidShape>;

/// φ(x): distance to the surface, negative inside [m].
double signed_distance(const Shape& shape, const Vec3& x);

/// n = ∇φ/‖∇φ‖ at x, always a unit vector: where ∇φ is not defined (a sphere's
/// centre, an edge of a box), some fixed outward direction.
Vec3 outward_normal(const Shape& shape, const Vec3& x);

/// Membership as the sampling uses it: boundaries at min included, at max
/// excluded, so that adjoining boxes share no particle.
bool contains(const Shape& shape, const Vec3& x);

/// Axis-aligned bounds; none for a half-space.
std::optional<Bounds> bounds(const Shape& shape);

/// The point about which a body or collider of this shape rotates unless the
/// scene says otherwise: the centre of a sphere or cylinder, the middle of a
/// box or of the bounds of a sampled shape or solid, the `point` of a half-space.
Vec3 center(const Shape& shape);

/// Upper bound of |φ(x) − φ(y)| / ‖x − y‖: 1 for the analytic shapes.
double lipschitz_bound(const Shape& shape);

}  // namespace firn
