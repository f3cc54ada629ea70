// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// STL: a list of triangles, as text or binary (little endian).

#include <string>
#include <string_view>

#include "io/mesh/triangle_mesh.hpp"

namespace firn {

/// Triangles of an STL file, welded; the normals that it states are not used.
/// A file whose length is 84 + 50 n, with n its 32-bit count, is binary, whatever
/// its first word; so is one whose first 84 bytes are no text. A pure function of its input; throws
/// InputError.
TriangleMesh parse_stl(std::string_view bytes, const std::string& where = "STL");

}  // namespace firn
