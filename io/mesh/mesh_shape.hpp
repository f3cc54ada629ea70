// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Shapes from files: closed triangle meshes and level sets, as distances on a grid.

#include <string>

#include "firn/shape.hpp"
#include "io/mesh/triangle_mesh.hpp"

namespace firn {

/// True if this build has OpenVDB; without it the functions below that make a
/// shape throw an InputError which says so.
bool has_openvdb();

/// The welded triangles of a closed .obj or .stl file. Throws InputError.
TriangleMesh read_mesh(const std::string& path);

/// Solid of a closed .obj or .stl file, every vertex X moved to
/// scale·X + translate [m], for use on a grid of spacing h: the distances are
/// sampled at h/2. Throws InputError, beginning with the path.
Shape load_mesh_shape(const std::string& path, double scale, const Vec3& translate, double h);

/// Solid {φ ≤ 0} of the first float level set in a .vdb file, sampled as the
/// file is; beyond the file's narrow band the distance to its surface is
/// recomputed. Throws InputError, beginning with the path.
Shape load_level_set_shape(const std::string& path);

}  // namespace firn
