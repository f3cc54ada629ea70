// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/mesh_shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>

#include "firn/error.hpp"
#include "firn/sampled_distance.hpp"
#include "io/mesh/mesh_solid.hpp"
#include "io/mesh/thin_places.hpp"
#include "io/mesh/volume.hpp"

namespace firn {

namespace {

TriangleMesh placed_mesh(const std::string& path, double scale, const Vec3& translate) {
  TriangleMesh mesh = read_mesh(path);
  for (Vec3& x : mesh.vertices) {
    x = scale * x + translate;
    const double largest = x.cwiseAbs().maxCoeff();
    if (!(largest <= largest_coordinate))
      throw InputError(path, "coordinate after scale and translate", to_text(largest),
                       "at most " + to_text(largest_coordinate));
  }
  return mesh;
}

/// Numbers of samples a distance `spacing` apart around a mesh; there may be too many.
std::array<double, 3> sample_counts(const Bounds& b, double spacing, double h) {
  // A node with mass lies up to 2 h from a particle: with twice that beyond the surface,
  // containers have exact distances wherever they are asked for.
  const double margin = std::round(4 * h / spacing);
  std::array<double, 3> size;
  for (int axis = 0; axis < 3; ++axis)
    size[axis] = std::ceil((b.max[axis] - b.min[axis]) / spacing) + 1 + 2 * margin;
  return size;
}

/// A grid around the mesh, with its middle in the middle so that a symmetric
/// mesh has symmetric samples.
SampleGrid grid_around(const Bounds& b, double spacing, double h, const std::string& where) {
  const std::array<double, 3> size = sample_counts(b, spacing, h);
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

/// Calls visit(index, point, distance to the mesh) for the points of the grid that `wanted`
/// names.
template <class Wanted, class Visit>
void for_each_distance(const TriangleTree& tree, const SampleGrid& grid, Wanted wanted,
                       Visit visit) {
  std::size_t index = 0;
  std::int32_t nearest = -1;
  for (int i = 0; i < grid.size[0]; ++i)
    for (int j = 0; j < grid.size[1]; ++j)
      for (int k = 0; k < grid.size[2]; ++k, ++index) {
        if (!wanted(index)) continue;
        const Vec3 x = grid.point(i, j, k);
        visit(index, x, tree.distance(x, nearest));
      }
}

bool has_solid(const std::vector<float>& phi) {
  return std::any_of(phi.begin(), phi.end(), [](float value) { return value <= 0; });
}

Shape make_shape(const SampleGrid& grid, std::vector<float> phi, const std::string& where) try {
  return SampledShape{std::make_shared<const SampledDistance>(grid.origin, grid.spacing, grid.size,
                                                              std::move(phi))};
} catch (const std::invalid_argument& error) {
  throw InputError(where + ": " + error.what());
}

/// The signed distances to the solid within the mesh; none if no sample lies in it.
std::optional<Shape> sampled(const MeshSolid& solid, const TriangleMesh& mesh, double spacing,
                             double h, const std::string& where) {
  const SampleGrid grid = grid_around(bounds(mesh), spacing, h, where);
  std::vector<std::int16_t> count(grid.count(), 0);
  for (const Shell& shell : solid.shells())
    count_inside(shell.mesh, grid, shell.hollow ? -1 : 1, count, where);
  std::vector<float> phi(grid.count());
  bool inside = false;
  double last = 0;  // distance at the sample before
  for_each_distance(
      TriangleTree(mesh), grid, [](std::size_t) { return true; },
      [&](std::size_t index, const Vec3& x, double distance) {
        // Flooded signs lose narrow hollows. They decide samples on the surface only, where a
        // mesh that lies on the planes of the samples needs one rule for all of them.
        if (distance < 1e-3 * spacing)
          inside = count[index] > 0;
        else if (!(last > 1.01 * spacing) || index % grid.size[2] == 0)
          inside = solid.contains(x);
        last = distance;
        phi[index] = static_cast<float>(inside ? -distance : distance);
      });
  if (!has_solid(phi)) return std::nullopt;
  return make_shape(grid, std::move(phi), where);
}

/// Four digits: enough to find a place.
std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// Samples are h/2 apart, or down to h/16 where the mesh needs it and this many suffice.
constexpr double finest = 16, most_refined_samples = 1 << 23;

}  // namespace

void require_samples_fit(const std::array<double, 3>& size, const std::string& where) {
  const double count = size[0] * size[1] * size[2];
  if (!(count <= largest_number_of_samples))
    throw InputError(where, "number of distance samples", to_text(count),
                     "at most " + to_text(largest_number_of_samples));
}

Shape load_mesh_solid(const std::string& path, double scale, const Vec3& translate) {
  return SolidShape{std::make_shared<const MeshSolid>(placed_mesh(path, scale, translate), path)};
}

Shape load_mesh_shape(const std::string& path, double scale, const Vec3& translate, double h) {
  const TriangleMesh mesh = placed_mesh(path, scale, translate);
  require_samples_fit(sample_counts(bounds(mesh), h / 2, h), path);
  const MeshSolid solid(mesh, path);
  const std::vector<ThinPlace> places = thin_places(solid, h);
  std::optional<ThinPlace> lost;
  double spacing = h / 2;
  for (;; spacing /= 2) {
    const std::optional<Shape> shape = sampled(solid, mesh, spacing, h, path);
    lost = shape ? unresolved(places, *shape, h) : std::nullopt;
    if (shape && !lost) return *shape;
    const std::array<double, 3> finer = sample_counts(bounds(mesh), spacing / 2, h);
    if (spacing <= h / finest || finer[0] * finer[1] * finer[2] > most_refined_samples) break;
  }
  const std::string least = to_text(spacing) + " m between samples";
  if (!lost)
    throw InputError(path, "solid", "one that holds no sample point",
                     "one thicker than the distance of " + least);
  const Vec3& at = lost->middle;
  throw InputError(path,
                   (lost->wall ? "thickness of the wall at (" : "width of the opening at (") +
                       rounded(at[0]) + ", " + rounded(at[1]) + ", " + rounded(at[2]) + ")",
                   rounded(lost->thickness) + " m",
                   "more than the distance of " + least + ", the shortest for this mesh and h");
}

Shape load_level_set_shape(const std::string& path, const std::string& grid) {
  LevelSet level_set = read_level_set(path, grid);
  std::vector<float>& phi = level_set.phi;
  const auto beyond_band = [&](std::size_t index) {
    return !(std::abs(phi[index]) < level_set.band);
  };
  for_each_distance(TriangleTree(level_set.surface), level_set.grid, beyond_band,
                    [&](std::size_t index, const Vec3&, double distance) {
                      phi[index] = std::copysign(
                          static_cast<float>(std::max(distance, level_set.band)), phi[index]);
                    });
  if (!has_solid(phi))
    throw InputError(path, "level set", "one without a sample in its solid", "a solid");
  return make_shape(level_set.grid, std::move(phi), path);
}

}  // namespace firn
