// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Walls and openings of a mesh that samples of its distance may miss.

#include <optional>
#include <vector>

#include "io/mesh/mesh_solid.hpp"

namespace firn {

/// A piece of the surface that faces another one closely.
struct ThinPlace {
  Vec3 middle;       ///< halfway between the two
  double thickness;  ///< between them, along the normal of the piece [m]
  double area;       ///< of the piece [m²]
  bool wall;         ///< solid between the two; otherwise an opening
};

/// All places thinner than h, on pieces of the surface some h/4 across. Where two faces meet
/// at an angle they get arbitrarily near each other, so places less than h from such an edge
/// are left out: a sharp edge may lose that much.
std::vector<ThinPlace> thin_places(const MeshSolid& solid, double h);

/// The place where φ, positive outside, has the wrong sign over the largest area: over more
/// than (h/4)² within a cell of edge h, seen from both sides. None if φ resolves them all.
std::optional<ThinPlace> unresolved(const std::vector<ThinPlace>& places, const Shape& shape,
                                    double h);

}  // namespace firn
