// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/mesh_solid.hpp"

#include <Eigen/Geometry>

namespace firn {

namespace {

std::vector<TriangleMesh> meshes_of(const std::vector<Shell>& shells) {
  std::vector<TriangleMesh> meshes;
  for (const Shell& shell : shells) meshes.push_back(shell.mesh);
  return meshes;
}

/// The sum over the shells, unless two of them may overlap: a hollow lies in its solid, and
/// other shells have boxes of their own or lie in one another, which the sum counts twice.
std::optional<double> enclosed_volume(const std::vector<Shell>& shells) {
  constexpr std::size_t most = 1000;  // pairs take time
  if (shells.size() > most) return std::nullopt;
  std::vector<Bounds> solids;
  double volume = 0;
  for (const Shell& shell : shells) {
    volume += shell.hollow ? -shell.volume : shell.volume;
    if (shell.hollow) continue;
    const Bounds b = bounds(shell.mesh);
    for (const Bounds& other : solids)
      if ((b.min.array() < other.max.array()).all() && (other.min.array() < b.max.array()).all())
        return std::nullopt;
    solids.push_back(b);
  }
  return volume;
}

}  // namespace

MeshSolid::MeshSolid(const TriangleMesh& mesh, const std::string& where)
    : shells_(solid_shells(mesh, where)),
      winding_(meshes_of(shells_)),
      bounds_(firn::bounds(surface())),
      volume_(enclosed_volume(shells_)) {}

bool MeshSolid::contains(const Vec3& x) const {
  thread_local std::vector<WindingNumbers::Around> around;
  winding_.find(x, around);
  int count = 0;
  for (const auto& a : around) count += shells_[a.part].hollow ? -1 : 1;
  return count > 0;
}

double MeshSolid::distance(const Vec3& x) const {
  std::int32_t nearest = -1;
  const double distance = tree().distance(x, nearest);
  return contains(x) ? -distance : distance;
}

Vec3 MeshSolid::normal(const Vec3& x) const {
  std::int32_t nearest = -1;
  tree().distance(x, nearest);
  const auto& [a, b, c] = surface().triangles[nearest];
  const Vec3 away =
      x - nearest_point(x, surface().vertices[a], surface().vertices[b], surface().vertices[c]);
  // Nearer to the surface than roundoff the face itself tells.
  const double size = away.norm();
  if (size > 1e-12 * x.cwiseAbs().maxCoeff()) return (contains(x) ? -away : away) / size;
  const Vec3 face = face_normal(nearest);
  return face.isZero(0) ? Vec3(Vec3::UnitZ()) : face;
}

Vec3 MeshSolid::face_normal(std::int32_t triangle) const {
  const auto& [a, b, c] = surface().triangles[triangle];
  const std::vector<Vec3>& v = surface().vertices;
  const Vec3 n = (v[b] - v[a]).cross(v[c] - v[a]);
  const double size = n.norm();
  if (!(size > 0)) return Vec3::Zero();
  return (shells_[winding_.part_of(triangle)].hollow ? -n : n) / size;
}

}  // namespace firn
