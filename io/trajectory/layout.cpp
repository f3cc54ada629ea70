// SPDX-License-Identifier: BSD-3-Clause
#include "io/trajectory/layout.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <vector>

#include "firn/registry.hpp"
#include "io/hdf5/write.hpp"
#include "io/trajectory/vtkhdf_group.hpp"

namespace firn {

namespace {

hsize_t as_size(std::int64_t n) { return static_cast<hsize_t>(n); }

/// 0, stride, 2·stride, …
std::vector<std::int64_t> multiples(std::int64_t stride, std::int64_t count) {
  std::vector<std::int64_t> values(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = stride * static_cast<std::int64_t>(k);
  return values;
}

void create_particle_arrays(hid_t file, Precision precision, std::int64_t points) {
  const hid_t real = precision == Precision::float64 ? H5T_IEEE_F64LE : H5T_IEEE_F32LE;
  const Particles none;
  hdf5::create_group(file, "/VTKHDF/PointData");
  for_each_array(
      [&]<class T>(const ParticleArray& array, const std::vector<T>&) {
        const hid_t integer = sizeof(T) == 8 ? H5T_STD_I64LE : H5T_STD_I32LE;
        const hid_t type = array.integer ? integer : real;
        if (array.components == 1)
          hdf5::create_dataset(file, array.path, type, {as_size(points)}, array.units);
        else
          hdf5::create_dataset(file, array.path, type, {as_size(points), as_size(array.components)},
                               array.units);
      },
      none);
}

/// One vertex per particle, the same for every frame; no lines, no polygons.
void create_cells(hid_t file, std::int64_t particles) {
  for (const std::string kind : {"Vertices", "Lines", "Polygons", "Strips"}) {
    const std::int64_t cells = kind == "Vertices" ? particles : 0;
    const std::string group = "/VTKHDF/" + kind;
    hdf5::create_group(file, group);
    hdf5::write_constant(file, group + "/NumberOfCells", {1}, std::array{cells});
    hdf5::write_constant(file, group + "/NumberOfConnectivityIds", {1}, std::array{cells});
    hdf5::write_constant(file, group + "/Offsets", {as_size(cells + 1)}, multiples(1, cells + 1));
    hdf5::write_constant(file, group + "/Connectivity", {as_size(cells)}, multiples(1, cells));
  }
}

/// Where each frame's particles begin: known for all frames beforehand. There
/// is one part, the same for all frames, as the number of particles is. NSteps
/// and Values come first and together, see TrajectoryFile::count_frames().
void create_steps(hid_t file, std::int64_t particles, std::int64_t frames) {
  const std::string steps = "/VTKHDF/Steps";
  hdf5::create_group(file, steps);
  hdf5::Id group(hdf5::written(H5Gopen2(file, steps.c_str(), H5P_DEFAULT), steps), H5Gclose);
  hdf5::write_integer(group.get(), steps, "NSteps", 0);
  hdf5::create_growing_dataset(file, steps + "/Values", H5T_IEEE_F64LE, 1, as_size(frames), "s");

  const std::vector<std::int64_t> zeros(static_cast<std::size_t>(4 * frames), 0);
  const std::vector<std::int64_t> ones(static_cast<std::size_t>(frames), 1);
  const std::vector<std::int64_t> first_point = multiples(particles, frames);
  const hsize_t n = as_size(frames);
  hdf5::write_constant(file, steps + "/NumberOfParts", {n}, ones);
  hdf5::write_constant(file, steps + "/PartOffsets", {n}, zeros);
  hdf5::write_constant(file, steps + "/PointOffsets", {n}, first_point);
  hdf5::write_constant(file, steps + "/CellOffsets", {n, 4}, zeros);
  hdf5::write_constant(file, steps + "/ConnectivityIdOffsets", {n, 4}, zeros);
  hdf5::create_group(file, steps + "/PointDataOffsets");
  for_each_array([&](const ParticleArray& array) {
    if (is_point_data(array))
      hdf5::write_constant(file, steps + "/PointDataOffsets/" + array.name, {n}, first_point);
  });
}

void create_vtkhdf(hid_t file, Precision precision, const TrajectorySize& size) {
  create_vtkhdf_group(file);
  hdf5::write_constant(file, "/VTKHDF/NumberOfPoints", {1}, std::array{size.particles});
  create_steps(file, size.particles, size.frames);
  create_cells(file, size.particles);
  create_particle_arrays(file, precision, size.particles * size.frames);
}

void create_firn(hid_t file, const TrajectoryInfo& info, const TrajectorySize& size) {
  const std::string firn = "/firn";
  hdf5::create_group(file, firn);
  hdf5::Id group(hdf5::written(H5Gopen2(file, firn.c_str(), H5P_DEFAULT), firn), H5Gclose);
  hdf5::write_text(group.get(), firn, "format", std::string(trajectory_format));
  hdf5::write_integer(group.get(), firn, "version", trajectory_version);
  hdf5::write_text(group.get(), firn, "solver", info.solver);
  hdf5::write_text(group.get(), firn, "precision", std::string(name(info.precision)));
  hdf5::write_integer(group.get(), firn, "threads", info.threads);
  hdf5::write_text(group.get(), firn, "firn_version", info.firn_version);
  hdf5::write_text(group.get(), firn, "processor", info.processor);
  hdf5::write_text(group.get(), firn, "scene", info.scene);
  hdf5::create_dataset(file, firn + "/steps", H5T_STD_I64LE, {as_size(size.frames)}, "1");
  if (size.restart_size > 0)
    hdf5::create_dataset(file, firn + "/restart", H5T_STD_U8LE,
                         {as_size(size.frames), static_cast<hsize_t>(size.restart_size)}, "1");

  const std::string diagnostics = firn + "/diagnostics";
  hdf5::create_group(file, diagnostics);
  hdf5::Id rows(hdf5::written(H5Gopen2(file, diagnostics.c_str(), H5P_DEFAULT), diagnostics),
                H5Gclose);
  hdf5::write_integer(rows.get(), diagnostics, "rows", 0);
  for (const DiagnosticsColumn& column : diagnostics_columns) {
    const std::string name = diagnostics + "/" + column.name;
    const hid_t type = column.integer ? H5T_STD_I64LE : H5T_IEEE_F64LE;
    if (column.components == 1)
      hdf5::create_dataset(file, name, type, {as_size(size.rows)}, column.units);
    else
      hdf5::create_dataset(file, name, type, {as_size(size.rows), as_size(column.components)},
                           column.units);
  }
}

}  // namespace

double TrajectorySize::bytes(Precision precision) const {
  const double real_bytes = precision == Precision::float64 ? 8 : 4;
  double particle_bytes = 0;
  const Particles none;
  for_each_array(
      [&]<class T>(const ParticleArray& array, const std::vector<T>&) {
        particle_bytes += array.integer ? sizeof(T) : array.components * real_bytes;
      },
      none);
  const double N = static_cast<double>(particles);
  const double step_bytes = 8 * (1 + 3 + 4 + 4 + 7 + 1);  // Steps/*, and the frame's step number
  return static_cast<double>(frames) *
             (N * particle_bytes + step_bytes + static_cast<double>(restart_size)) +
         static_cast<double>(rows) * diagnostics_row_bytes + 16 * N;  // the vertices
}

void create_trajectory_layout(hid_t file, const TrajectoryInfo& info, const TrajectorySize& size) {
  create_vtkhdf(file, info.precision, size);
  create_firn(file, info, size);
}

}  // namespace firn
