// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Wavefront OBJ: text with one statement a line.

#include <string>
#include <string_view>

#include "io/mesh/triangle_mesh.hpp"

namespace firn {

/// Triangles of the statements `v` and `f`, welded. Polygons are split as fans
/// from their first corner, so they should be convex. Statements without a
/// surface of their own (normals, texture, groups, materials, lines) are passed
/// over, anything else is an error. A pure function of its input; throws
/// InputError with `where:line`.
TriangleMesh parse_obj(std::string_view text, const std::string& where = "OBJ");

}  // namespace firn
