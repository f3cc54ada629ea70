// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The solid within a closed mesh, known exactly at every point.

#include <optional>
#include <string>
#include <vector>

#include "firn/shape.hpp"
#include "io/mesh/solid_shells.hpp"
#include "io/mesh/winding.hpp"

namespace firn {

/// A point belongs to the solid if more solid shells than hollows wind around it: no
/// samples, so that walls and openings of any width count.
class MeshSolid final : public Solid {
 public:
  /// The mesh must be closed (require_closed()). Throws InputError as solid_shells() does.
  MeshSolid(const TriangleMesh& mesh, const std::string& where);

  bool contains(const Vec3& x) const override;
  double distance(const Vec3& x) const override;
  Vec3 normal(const Vec3& x) const override;
  Bounds bounds() const override { return bounds_; }
  std::optional<double> volume() const override { return volume_; }

  const std::vector<Shell>& shells() const { return shells_; }

  /// The triangles of all shells.
  const TriangleMesh& surface() const { return winding_.surface(); }
  const TriangleTree& tree() const { return winding_.tree(); }

  /// Unit normal of a triangle, out of the solid; zero if it has no area.
  Vec3 face_normal(std::int32_t triangle) const;

 private:
  std::vector<Shell> shells_;
  WindingNumbers winding_;
  Bounds bounds_;
  std::optional<double> volume_;
};

}  // namespace firn
