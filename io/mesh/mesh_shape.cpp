// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/mesh_shape.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "firn/error.hpp"
#include "firn/sampled_distance.hpp"
#include "io/mesh/parse_obj.hpp"
#include "io/mesh/parse_stl.hpp"
#include "io/mesh/triangle_tree.hpp"
#include "io/mesh/volume.hpp"

namespace firn {

namespace {

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file ? std::streamoff(file.tellg()) : -1;
  constexpr std::streamoff largest = std::streamoff(1) << 32;
  if (size < 0 || size > largest)  // a directory opens, too, and tells an absurd size
    throw InputError(path, "file", size < 0 ? "one that cannot be opened" : to_text(double(size)),
                     "a readable file of at most 4294967296 bytes");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  file.seekg(0);
  if (!file.read(bytes.data(), size))
    throw InputError(path, "file", "an error while reading", "a readable file");
  return bytes;
}

std::string extension(const std::string& path) {
  const std::size_t dot = path.find_last_of("./\\");
  std::string text = dot == std::string::npos || path[dot] != '.' ? "" : path.substr(dot);
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

void place(TriangleMesh& mesh, double scale, const Vec3& translate, const std::string& where) {
  for (Vec3& x : mesh.vertices) {
    x = scale * x + translate;
    const double largest = x.cwiseAbs().maxCoeff();
    if (!(largest <= largest_coordinate))
      throw InputError(where, "coordinate after scale and translate", to_text(largest),
                       "at most " + to_text(largest_coordinate));
  }
}

/// A grid around the mesh, with its middle in the middle so that a symmetric
/// mesh has symmetric samples.
SampleGrid grid_around(const TriangleMesh& mesh, double spacing, const std::string& where) {
  // Samples beyond the surface. A node with mass lies up to 2 h from a particle:
  // with twice that, containers have exact distances wherever they are asked for.
  constexpr int margin = 8;
  const Bounds b = bounds(mesh);
  std::array<double, 3> size;
  for (int axis = 0; axis < 3; ++axis)
    size[axis] = std::ceil((b.max[axis] - b.min[axis]) / spacing) + 1 + 2 * margin;
  require_samples_fit(size, where);
  SampleGrid grid;
  grid.spacing = spacing;
  for (int axis = 0; axis < 3; ++axis) {
    grid.size[axis] = static_cast<int>(size[axis]);
    grid.origin[axis] =
        b.min[axis] + 0.5 * (b.max[axis] - b.min[axis]) - 0.5 * spacing * (size[axis] - 1);
  }
  return grid;
}

/// In how many shells every point lies, hollows counted as −1: OpenVDB by itself
/// fills them. The largest shell of a mesh is an outer one, which tells how its
/// triangles turn.
std::vector<std::int16_t> count_shells_around(const TriangleMesh& mesh, const SampleGrid& grid,
                                              const std::string& where) {
  const std::vector<TriangleMesh> parts = shells(mesh);
  constexpr std::size_t most = 32767;  // what the counts hold
  if (parts.size() > most)
    throw InputError(where, "separate surfaces", std::to_string(parts.size()),
                     "at most " + std::to_string(most));
  double largest = 0;
  for (const TriangleMesh& part : parts)
    if (std::abs(signed_volume(part)) > std::abs(largest)) largest = signed_volume(part);
  std::vector<std::int16_t> count(grid.count(), 0);
  for (const TriangleMesh& part : parts)
    count_inside(part, grid, signed_volume(part) * largest >= 0 ? 1 : -1, count, where);
  return count;
}

/// Calls visit(index, distance to the mesh) for the points of the grid that `wanted` names.
template <class Wanted, class Visit>
void for_each_distance(const TriangleMesh& mesh, const SampleGrid& grid, Wanted wanted,
                       Visit visit) {
  const TriangleTree tree(mesh);
  std::size_t index = 0;
  std::int32_t nearest = -1;
  for (int i = 0; i < grid.size[0]; ++i)
    for (int j = 0; j < grid.size[1]; ++j)
      for (int k = 0; k < grid.size[2]; ++k, ++index)
        if (wanted(index)) visit(index, tree.distance(grid.point(i, j, k), nearest));
}

Shape make_shape(const SampleGrid& grid, std::vector<float> phi, const std::string& where) try {
  if (std::none_of(phi.begin(), phi.end(), [](float value) { return value <= 0; }))
    throw InputError(
        where, "solid", "one that holds no sample point",
        "one thicker than the distance of " + to_text(grid.spacing) + " m between samples");
  return SampledShape{std::make_shared<const SampledDistance>(grid.origin, grid.spacing, grid.size,
                                                              std::move(phi))};
} catch (const std::invalid_argument& error) {
  throw InputError(where + ": " + error.what());
}

}  // namespace

void require_samples_fit(const std::array<double, 3>& size, const std::string& where) {
  const double count = size[0] * size[1] * size[2];
  if (!(count <= largest_number_of_samples))
    throw InputError(where, "number of distance samples", to_text(count),
                     "at most " + to_text(largest_number_of_samples));
}

TriangleMesh read_mesh(const std::string& path) {
  const std::string type = extension(path);
  if (type != ".obj" && type != ".stl")
    throw InputError(path, "kind of mesh file", "\"" + type + "\"", ".obj or .stl");
  TriangleMesh mesh =
      type == ".obj" ? parse_obj(read_file(path), path) : parse_stl(read_file(path), path);
  require_closed(mesh, path);
  return mesh;
}

Shape load_mesh_shape(const std::string& path, double scale, const Vec3& translate, double h) {
  TriangleMesh mesh = read_mesh(path);
  place(mesh, scale, translate, path);
  const SampleGrid grid = grid_around(mesh, h / 2, path);
  const std::vector<std::int16_t> inside = count_shells_around(mesh, grid, path);
  std::vector<float> phi(grid.count());
  for_each_distance(
      mesh, grid, [](std::size_t) { return true; },
      [&](std::size_t index, double distance) {
        phi[index] = static_cast<float>(inside[index] > 0 ? -distance : distance);
      });
  return make_shape(grid, std::move(phi), path);
}

Shape load_level_set_shape(const std::string& path) {
  LevelSet level_set = read_level_set(path);
  std::vector<float>& phi = level_set.phi;
  const auto beyond_band = [&](std::size_t index) {
    return !(std::abs(phi[index]) < level_set.band);
  };
  for_each_distance(
      level_set.surface, level_set.grid, beyond_band, [&](std::size_t index, double distance) {
        phi[index] =
            std::copysign(static_cast<float>(std::max(distance, level_set.band)), phi[index]);
      });
  return make_shape(level_set.grid, std::move(phi), path);
}

}  // namespace firn
