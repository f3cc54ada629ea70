// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What must hold for whatever a mesh parser lets pass.

#include <cmath>
#include <string>
#include <string_view>

#include "io/mesh/triangle_mesh.hpp"
#include "verification/fuzz/judge.hpp"

namespace firn::fuzz {

/// The parser throws an InputError, or gives a mesh whose triangles name three different
/// vertices with coordinates in range; if it is closed it falls into closed shells.
inline void judge_mesh_parser(TriangleMesh (*parse)(std::string_view, const std::string&),
                              std::string_view bytes) {
  const std::string where = "fuzz.mesh";
  try {
    const TriangleMesh mesh = parse(bytes, where);
    for (const Vec3& x : mesh.vertices)
      require(x.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= largest_coordinate, "coordinate",
              "out of range");
    for (const Triangle& t : mesh.triangles) {
      for (const std::int32_t corner : t)
        require(corner >= 0 && static_cast<std::size_t>(corner) < mesh.vertices.size(), "corner",
                std::to_string(corner));
      require(t[0] != t[1] && t[1] != t[2] && t[2] != t[0], "triangle", "without area");
    }
    require_closed(mesh, where);
    std::size_t triangles = 0;
    for (const TriangleMesh& shell : shells(mesh)) {
      require_closed(shell, where);
      triangles += shell.triangles.size();
      require(std::isfinite(signed_volume(shell)), "volume", "not finite");
    }
    require(triangles == mesh.triangles.size(), "shells", "do not add up");
  } catch (const InputError& error) {
    require_message(error, where);
  }
}

}  // namespace firn::fuzz
