// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A surface of triangles and what makes it the boundary of a solid.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "firn/shape.hpp"

namespace firn {

using Triangle = std::array<std::int32_t, 3>;  ///< indices into TriangleMesh::vertices

struct TriangleMesh {
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<Triangle> triangles;
};

/// What the readers accept at most: some 2 GB of memory.
inline constexpr std::size_t largest_number_of_triangles = 20'000'000;

/// Largest |coordinate|, as for every length in a scene [m].
inline constexpr double largest_coordinate = 1e9;

/// Gives vertices of equal position one index, then drops triangles that use
/// one vertex twice: such triangles cover nothing, and files repeat vertices at
/// seams (OBJ) or for every triangle (STL).
void weld(TriangleMesh& mesh);

/// As above for vertices up to `tolerance` apart [m], also through others in between. The mesh
/// must be welded already.
void weld(TriangleMesh& mesh, double tolerance);

/// True if every edge belongs to exactly two triangles.
bool is_closed(const TriangleMesh& mesh);

/// Throws InputError unless the surface has triangles and every edge belongs to
/// exactly two of them. `where` names the file. The mesh must be welded.
void require_closed(const TriangleMesh& mesh, const std::string& where);

/// The parts of a closed mesh that hang together by edges, each with vertices of
/// its own: a solid has one outer shell, and one more for every hollow.
std::vector<TriangleMesh> shells(const TriangleMesh& mesh);

/// Turns the triangles of a closed mesh of one shell so that any two at an edge run along it
/// in opposite directions: the way that most of them turn already. False if there is no
/// such way, as for a Klein bottle.
bool turn_alike(TriangleMesh& shell);

/// Reverses every triangle.
void turn_over(TriangleMesh& mesh);

/// Volume that a closed mesh encloses, negative if its triangles turn clockwise
/// seen from outside [m³].
double signed_volume(const TriangleMesh& mesh);

/// Bounds of the vertices; the mesh must have some.
Bounds bounds(const TriangleMesh& mesh);

/// "(x, y, z)" for messages.
std::string point_text(const Vec3& x);

}  // namespace firn
