// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Polygons in space cut into triangles.

#include <cstdint>
#include <vector>

#include "io/mesh/triangle_mesh.hpp"

namespace firn {

/// Appends the triangles of the polygon with these corners (at least 3, indices into
/// `vertices`) to `triangles`, with the polygon's turn. Convex polygons become fans from their
/// first corner, all others lose one ear after another (Meisters 1975). Corners may lie on
/// one line, and a bridge may join a polygon to its holes. Seen along its mean normal the polygon
/// must not cross itself: false if it does, and then nothing is appended.
bool append_polygon(const std::vector<Vec3>& vertices, const std::vector<std::int32_t>& corners,
                    std::vector<Triangle>& triangles);

}  // namespace firn
