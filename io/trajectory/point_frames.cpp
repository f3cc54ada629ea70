// SPDX-License-Identifier: BSD-3-Clause
#include "io/trajectory/point_frames.hpp"

#include <array>
#include <numeric>

#include "io/hdf5/write.hpp"
#include "io/trajectory/vtkhdf_group.hpp"

namespace firn {

namespace {

hsize_t as_size(std::size_t n) { return static_cast<hsize_t>(n); }

/// 0, sizes[0], sizes[0] + sizes[1], …: where each frame begins.
std::vector<std::int64_t> starts(const std::vector<std::int64_t>& sizes) {
  std::vector<std::int64_t> first(sizes.size());
  std::exclusive_scan(sizes.begin(), sizes.end(), first.begin(), std::int64_t{0});
  return first;
}

/// One vertex per point; no lines, no polygons.
void write_cells(hid_t file, const std::vector<std::int64_t>& points) {
  for (const std::string kind : {"Vertices", "Lines", "Polygons", "Strips"}) {
    std::vector<std::int64_t> counts(points.size()), offsets, connectivity;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (kind == "Vertices") counts[k] = points[k];
      for (std::int64_t p = 0; p <= counts[k]; ++p) offsets.push_back(p);
      for (std::int64_t p = 0; p < counts[k]; ++p) connectivity.push_back(p);
    }
    const std::string group = "/VTKHDF/" + kind;
    hdf5::create_group(file, group);
    hdf5::write_constant(file, group + "/NumberOfCells", {as_size(counts.size())}, counts);
    hdf5::write_constant(file, group + "/NumberOfConnectivityIds", {as_size(counts.size())},
                         counts);
    hdf5::write_constant(file, group + "/Offsets", {as_size(offsets.size())}, offsets);
    hdf5::write_constant(file, group + "/Connectivity", {as_size(connectivity.size())},
                         connectivity);
  }
}

void write_steps(hid_t file, const std::vector<PointFrame>& frames,
                 const std::vector<std::int64_t>& points) {
  const std::string steps = "/VTKHDF/Steps";
  const std::size_t n = frames.size();
  hdf5::create_group(file, steps);
  hdf5::Id group(hdf5::written(H5Gopen2(file, steps.c_str(), H5P_DEFAULT), steps), H5Gclose);
  hdf5::write_integer(group.get(), steps, "NSteps", static_cast<std::int64_t>(n));
  std::vector<double> times;
  for (const PointFrame& frame : frames) times.push_back(frame.time);
  hdf5::write_numbers(file, steps + "/Values", times, "s");
  std::vector<std::int64_t> parts(n), ones(n, 1), cells, connectivity;
  std::iota(parts.begin(), parts.end(), 0);
  const std::vector<std::int64_t> first = starts(points);
  for (const std::int64_t start : first)
    for (const std::int64_t value : {start, std::int64_t{0}, std::int64_t{0}, std::int64_t{0}})
      cells.push_back(value);
  hdf5::write_constant(file, steps + "/NumberOfParts", {as_size(n)}, ones);
  hdf5::write_constant(file, steps + "/PartOffsets", {as_size(n)}, parts);
  hdf5::write_constant(file, steps + "/PointOffsets", {as_size(n)}, first);
  hdf5::write_constant(file, steps + "/CellOffsets", {as_size(n), 4}, cells);
  hdf5::write_constant(file, steps + "/ConnectivityIdOffsets", {as_size(n), 4}, cells);
  hdf5::create_group(file, steps + "/PointDataOffsets");
  for (const PointArray& array : frames.front().arrays)
    hdf5::write_constant(file, steps + "/PointDataOffsets/" + array.name, {as_size(n)}, first);
}

void write_floats(hid_t file, const std::string& name, std::size_t rows, int components,
                  const std::vector<float>& values) {
  const auto columns = static_cast<hsize_t>(components);
  const hdf5::Id dataset =
      components == 1
          ? hdf5::create_dataset(file, name, H5T_IEEE_F32LE, {as_size(rows)}, "1")
          : hdf5::create_dataset(file, name, H5T_IEEE_F32LE, {as_size(rows), columns}, "1");
  hdf5::write_rows(dataset.get(), name, 0, static_cast<std::int64_t>(rows), H5T_NATIVE_FLOAT,
                   values.data());
}

void write_points(hid_t file, const std::vector<PointFrame>& frames, std::size_t rows) {
  const std::string name = "/VTKHDF/Points";
  std::vector<double> x;
  for (const PointFrame& frame : frames)
    for (const Vec3& point : frame.points) x.insert(x.end(), point.data(), point.data() + 3);
  const hdf5::Id dataset =
      hdf5::create_dataset(file, name, H5T_IEEE_F64LE, {as_size(rows), 3}, "m");
  hdf5::write_rows(dataset.get(), name, 0, static_cast<std::int64_t>(rows), H5T_NATIVE_DOUBLE,
                   x.data());
}

void write_file(const std::filesystem::path& path, const std::string& format,
                const std::vector<PointFrame>& frames) {
  const hdf5::Id file = hdf5::open_or_create_file(path);
  const hdf5::Id group = hdf5::open_or_create_group(file.get(), "firn");
  hdf5::write_text(group.get(), "/firn", "format", format);
  hdf5::write_integer(group.get(), "/firn", "version", 1);
  std::vector<std::int64_t> points;
  std::size_t rows = 0;
  for (const PointFrame& frame : frames) {
    points.push_back(static_cast<std::int64_t>(frame.points.size()));
    rows += frame.points.size();
  }
  create_vtkhdf_group(file.get());
  hdf5::write_constant(file.get(), "/VTKHDF/NumberOfPoints", {as_size(points.size())}, points);
  write_steps(file.get(), frames, points);
  write_cells(file.get(), points);
  write_points(file.get(), frames, rows);
  hdf5::create_group(file.get(), "/VTKHDF/PointData");
  for (std::size_t a = 0; a < frames.front().arrays.size(); ++a) {
    const PointArray& first = frames.front().arrays[a];
    std::vector<float> values;
    for (const PointFrame& frame : frames)
      values.insert(values.end(), frame.arrays[a].values.begin(), frame.arrays[a].values.end());
    write_floats(file.get(), "/VTKHDF/PointData/" + first.name, rows, first.components, values);
  }
}

}  // namespace

void write_point_frames(const std::filesystem::path& path, const std::string& format,
                        const std::vector<PointFrame>& frames) {
  std::filesystem::path part = path;
  part += ".part";
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  write_file(part, format, frames);
  std::filesystem::rename(part, path);
}

}  // namespace firn
