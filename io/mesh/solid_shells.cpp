// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/solid_shells.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "firn/error.hpp"
#include "io/mesh/winding.hpp"

namespace firn {

namespace {

/// For every shell, those in which it lies: with more than half of its area, measured at the
/// middles of its triangles. Shells may touch, so that single points decide nothing.
std::vector<std::vector<std::int32_t>> shells_around(const std::vector<TriangleMesh>& parts) {
  const WindingNumbers winding(parts);
  const TriangleMesh& surface = winding.surface();
  std::vector<double> area(parts.size(), 0);
  std::vector<std::map<std::int32_t, double>> area_within(parts.size());
  std::vector<WindingNumbers::Around> around;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    const Vec3 &xa = surface.vertices[a], &xb = surface.vertices[b], &xc = surface.vertices[c];
    const double size = (xb - xa).cross(xc - xa).norm();
    const std::int32_t part = winding.part_of(static_cast<std::int32_t>(t));
    area[part] += size;
    winding.find((xa + xb + xc) / 3, around);
    for (const auto& other : around)
      if (other.part != part) area_within[part][other.part] += size;
  }
  std::vector<std::vector<std::int32_t>> outer(parts.size());
  for (std::size_t part = 0; part < parts.size(); ++part)
    for (const auto& [other, size] : area_within[part])
      if (size > 0.5 * area[part]) outer[part].push_back(other);
  return outer;
}

}  // namespace

std::vector<Shell> solid_shells(const TriangleMesh& mesh, const std::string& where) {
  std::vector<TriangleMesh> parts = shells(mesh);
  constexpr std::size_t most = 32767;  // what counts of shells around a point hold
  if (parts.size() > most)
    throw InputError(where, "separate surfaces", std::to_string(parts.size()),
                     "at most " + std::to_string(most));
  std::vector<double> volume;  // signed, as the file turns the triangles
  for (TriangleMesh& part : parts) {
    if (!turn_alike(part))
      throw InputError(where, "surface", "one with a single side, like a Klein bottle's",
                       "surfaces with an inside and an outside");
    volume.push_back(signed_volume(part));
    if (volume.back() < 0) turn_over(part);
  }

  std::vector<std::vector<std::int32_t>> outer(parts.size());
  if (parts.size() > 1) outer = shells_around(parts);
  std::vector<Shell> result;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    double outermost = 0;  // volume of the largest shell around this one that is in none
    for (const std::int32_t other : outer[part])
      if (outer[other].empty() && std::abs(volume[other]) > std::abs(outermost))
        outermost = volume[other];
    result.push_back(
        {std::move(parts[part]), std::abs(volume[part]), volume[part] * outermost < 0});
  }
  return result;
}

}  // namespace firn
