// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Which parts of a closed mesh are solids and which are hollows in them.

#include <string>
#include <vector>

#include "io/mesh/triangle_mesh.hpp"

namespace firn {

/// A part of a mesh that hangs together by edges.
struct Shell {
  TriangleMesh mesh;    ///< counterclockwise seen from outside the shell: volume ≥ 0
  double volume = 0;    ///< enclosed by this shell [m³]
  bool hollow = false;  ///< takes its inside away from the solid around it
};

/// The shells of a closed mesh, each turned as a whole, whichever way the file turns
/// its triangles. A shell that lies in no other is solid. One that lies in another is a
/// hollow if the file turns it the other way than the outermost shell around it, as
/// exporters do. A point belongs to the solid if it lies in more solid shells than hollows.
/// Throws InputError if there are too many shells or if one has a single side.
std::vector<Shell> solid_shells(const TriangleMesh& mesh, const std::string& where);

}  // namespace firn
