// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Shapes from files: closed triangle meshes and level sets.

#include <string>

#include "firn/shape.hpp"
#include "io/mesh/triangle_mesh.hpp"

namespace firn {

/// True if this build has OpenVDB; without it the functions below that make a
/// shape throw an InputError which says so.
bool has_openvdb();

/// The welded triangles of a closed .obj or .stl file. Where equal vertices alone leave the
/// surface open, vertices nearer than float roundoff of the mesh's size (2⁻²³ of its longest
/// side) become one, too. Throws InputError.
TriangleMesh read_mesh(const std::string& path);

/// Solid of a closed .obj or .stl file, every vertex X moved to scale·X + translate [m],
/// known exactly at every point: for bodies. Throws InputError, beginning with the path.
Shape load_mesh_solid(const std::string& path, double scale, const Vec3& translate);

/// The same solid for a collider on a grid of spacing h: distances sampled at h/2, or finer
/// where walls or openings need it (thin_places.hpp). Throws InputError, beginning with the
/// path, also where the finest samples lose a wall or an opening.
Shape load_mesh_shape(const std::string& path, double scale, const Vec3& translate, double h);

/// Solid {φ ≤ 0} of the float level set called `grid` in a .vdb file, or of the first one if
/// `grid` is empty, sampled as the file is; beyond the file's narrow band the distance
/// to its surface is recomputed. Throws InputError, beginning with the path, also for values
/// that are not finite and for signs that change without passing through the band.
Shape load_level_set_shape(const std::string& path, const std::string& grid = "");

}  // namespace firn
