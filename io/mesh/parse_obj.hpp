// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Wavefront OBJ: text with one statement a line.

#include <string>
#include <string_view>

#include "io/mesh/triangle_mesh.hpp"

namespace firn {

/// Triangles of the statements `v` and `f`, welded; append_polygon() cuts faces of
/// more than three corners. Statements without a surface of their own (normals,
/// texture, groups, materials, lines) are passed over, anything else is an
/// error. A pure function of its input; throws InputError with `where:line`.
TriangleMesh parse_obj(std::string_view text, const std::string& where = "OBJ");

}  // namespace firn
