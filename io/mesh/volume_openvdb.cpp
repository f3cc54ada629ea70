// SPDX-License-Identifier: BSD-3-Clause
// The only file that includes OpenVDB.

#include <array>
#include <cmath>
#include <exception>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include "firn/error.hpp"
#include "io/mesh/mesh_shape.hpp"
#include "io/mesh/mesh_text.hpp"
#include "io/mesh/volume.hpp"

namespace firn {

bool has_openvdb() { return true; }

/// OpenVDB marks the voxels at the surface, then floods signs from the outside.
void count_inside(const TriangleMesh& shell, const SampleGrid& grid, int amount,
                  std::vector<std::int16_t>& count, const std::string& where) try {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;  // in units of the grid: exact to some 1e-5 of a voxel
  for (const Vec3& vertex : shell.vertices) {
    const Vec3 x = (vertex - grid.origin) / grid.spacing;
    points.emplace_back(x[0], x[1], x[2]);
  }
  std::vector<openvdb::Vec3I> triangles;
  for (const Triangle& t : shell.triangles) triangles.emplace_back(t[0], t[1], t[2]);

  // This overload is compiled in the library; its like with a mesh adapter of our
  // own took 108 s to compile.
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> surface(
      points, triangles);
  openvdb::util::NullInterrupter never;
  const auto volume = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      never, surface, *openvdb::math::Transform::createLinearTransform(1.0), 1.0f, 1.0f);

  const auto values = volume->getConstAccessor();
  const Bounds b = bounds(shell);
  std::array<int, 3> low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = static_cast<int>((b.min[axis] - grid.origin[axis]) / grid.spacing);
    high[axis] = static_cast<int>((b.max[axis] - grid.origin[axis]) / grid.spacing) + 1;
  }
  for (int i = low[0]; i <= high[0]; ++i)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int k = low[2]; k <= high[2]; ++k)
        if (values.getValue({i, j, k}) < 0) count[grid.index(i, j, k)] += amount;
} catch (const openvdb::Exception& error) {
  throw InputError(where + ": OpenVDB rejects this mesh: " + error.what());
}

namespace {

constexpr std::size_t longest_name = 80;  // in messages

/// The level set of this name, or the first one if there is none to find.
openvdb::FloatGrid::Ptr find_level_set(const std::string& path, const std::string& wanted) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open(false);  // read at once: a file that changes later would crash the program
  std::string known;
  for (auto name = file.beginName(); name != file.endName(); ++name) {
    const auto metadata = file.readGridMetadata(*name);
    if (!metadata->isType<openvdb::FloatGrid>() ||
        metadata->getGridClass() != openvdb::GRID_LEVEL_SET)
      continue;
    if (wanted.empty() || *name == wanted)
      return openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(*name));
    known += (known.empty() ? "" : ", ") + firn::quoted(*name, longest_name);
  }
  if (known.empty()) throw InputError(path, "grids", "no level set of floats", "at least one");
  throw InputError(path, "level set", firn::quoted(wanted, longest_name),
                   "the file's level sets, " + known);
}

/// Edge of the voxels [m], which must be cubes along the axes.
double voxel_edge(const openvdb::FloatGrid& volume, const std::string& path) {
  const openvdb::Vec3d origin = volume.indexToWorld(openvdb::Vec3d(0.0));
  const double edge = volume.voxelSize()[0];
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d unit(0.0), expected(0.0);
    unit[axis] = 1;
    expected[axis] = edge;
    const openvdb::Vec3d step = volume.indexToWorld(unit) - origin;
    // Files state the map in double; a millionth of a voxel is its rounding
    // after a translation by up to 10⁹ voxels.
    if (!(edge > 0) || !((step - expected).length() <= 1e-6 * edge))
      throw InputError(path, "voxels", "turned, stretched or mirrored ones",
                       "cubes along the axes");
  }
  return edge;
}

TriangleMesh surface_of(const openvdb::FloatGrid& volume) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(volume, points, quads, 0.0);
  TriangleMesh mesh;
  for (const openvdb::Vec3s& x : points) mesh.vertices.emplace_back(x[0], x[1], x[2]);
  for (const openvdb::Vec4I& q : quads) {
    const auto corner = [&](int c) { return static_cast<std::int32_t>(q[c]); };
    mesh.triangles.push_back({corner(0), corner(1), corner(2)});
    mesh.triangles.push_back({corner(0), corner(2), corner(3)});
  }
  return mesh;
}

std::string voxel_text(const openvdb::Coord& voxel) {
  return "voxel (" + std::to_string(voxel[0]) + ", " + std::to_string(voxel[1]) + ", " +
         std::to_string(voxel[2]) + ")";
}

/// Every value is finite, and neighbours of opposite sign lie on either side of a surface between
/// them. In a file whose inside was never flooded the sign changes where the band ends.
void require_signed_distances(const LevelSet& level_set, const openvdb::Coord& corner,
                              const std::string& path) {
  const SampleGrid& grid = level_set.grid;
  const std::array<std::size_t, 3> stride{grid.index(1, 0, 0), grid.index(0, 1, 0), 1};
  // Distances differ by at most one voxel; fields that are distances only roughly by some more.
  const double steepest = 1.5 * grid.spacing;
  for (int i = 0; i < grid.size[0]; ++i)
    for (int j = 0; j < grid.size[1]; ++j)
      for (int k = 0; k < grid.size[2]; ++k) {
        const std::size_t here = grid.index(i, j, k);
        const float phi = level_set.phi[here];
        if (!std::isfinite(phi))
          throw InputError(path, voxel_text(corner.offsetBy(i, j, k)),
                           std::isnan(phi) ? "nan" : to_text(phi), "finite distances");
        const std::array<int, 3> at{i, j, k};
        for (int axis = 0; axis < 3; ++axis) {
          if (at[axis] == 0) continue;
          const float before = level_set.phi[here - stride[axis]];
          if ((phi > 0) == (before > 0) || !(std::abs(double(phi) - before) > steepest)) continue;
          throw InputError(
              path,
              "change of sign to " + voxel_text(corner.offsetBy(i, j, k)) + " from its neighbour",
              "a jump by " + to_text(std::abs(double(phi) - before)) + " m",
              "at most " + to_text(steepest) +
                  " m, 1.5 voxels (an inside that was never flooded with negative values?)");
        }
      }
}

}  // namespace

LevelSet read_level_set(const std::string& path, const std::string& grid) try {
  const openvdb::FloatGrid::Ptr volume = find_level_set(path, grid);
  const openvdb::CoordBBox box = volume->evalActiveVoxelBoundingBox();
  if (box.empty())
    throw InputError(path, "level set", "one without active voxels", "a narrow band of them");
  if (!(volume->background() > 0) || !std::isfinite(volume->background()))
    throw InputError(path, "background of the level set", to_text(volume->background()),
                     "finite, above 0");

  LevelSet level_set;
  level_set.grid.spacing = voxel_edge(*volume, path);
  level_set.band = volume->background();
  const openvdb::Coord corner = box.min().offsetBy(-1);
  const openvdb::Vec3d origin = volume->indexToWorld(corner);
  level_set.grid.origin = Vec3(origin[0], origin[1], origin[2]);
  std::array<double, 3> size;  // the active voxels and one more on either side
  for (int axis = 0; axis < 3; ++axis)
    size[axis] = static_cast<double>(box.max()[axis]) - box.min()[axis] + 3;
  require_samples_fit(size, path);
  for (int axis = 0; axis < 3; ++axis) level_set.grid.size[axis] = static_cast<int>(size[axis]);

  const auto values = volume->getConstAccessor();
  level_set.phi.reserve(level_set.grid.count());
  for (int i = 0; i < level_set.grid.size[0]; ++i)
    for (int j = 0; j < level_set.grid.size[1]; ++j)
      for (int k = 0; k < level_set.grid.size[2]; ++k)
        level_set.phi.push_back(values.getValue(corner.offsetBy(i, j, k)));
  require_signed_distances(level_set, corner, path);
  level_set.surface = surface_of(*volume);
  return level_set;
} catch (const InputError&) {
  throw;
} catch (const std::exception& error) {  // a damaged file may ask for absurd memory, too
  throw InputError(path + ": OpenVDB cannot read this file: " + error.what());
}

}  // namespace firn
