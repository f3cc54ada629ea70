// SPDX-License-Identifier: BSD-3-Clause
/// Opening a trajectory: everything is checked that can be without reading the
/// particles.

#include "io/trajectory/open.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firn/error.hpp"
#include "io/one_line.hpp"

namespace firn {

namespace {

constexpr std::int64_t any = std::numeric_limits<std::int64_t>::max();

std::string element(std::string dataset, std::size_t k) {
  return dataset.append("[").append(std::to_string(k)).append("]");
}

}  // namespace

TrajectoryReader::Open::Open(const std::filesystem::path& path) : file(path) {
  require_vtkhdf_polydata();
  read_steps();
  open_arrays();
  read_firn();
}

void TrajectoryReader::Open::require_vtkhdf_polydata() const {
  const std::string vtkhdf = "/VTKHDF";
  const std::vector<std::int64_t> version = file.integer_list_attribute(vtkhdf, "Version");
  if (version[0] != 2)
    throw InputError(file.where(vtkhdf) + ": attribute Version", "major version",
                     std::to_string(version[0]), "2");
  const std::string type = file.text_attribute(vtkhdf, "Type");
  if (type != "PolyData")
    throw InputError(file.where(vtkhdf) + ": attribute Type", "kind of data", one_line(type, 80),
                     "PolyData");
}

/// Data without time is one frame at t = 0.
void TrajectoryReader::Open::read_single_frame() {
  const hdf5::InputDataset parts = file.dataset("/VTKHDF/NumberOfPoints", hdf5::Kind::integer, 1);
  FramePlace frame;
  for (const std::int64_t more : file.integers("/VTKHDF/NumberOfPoints", parts.rows(), 0, any))
    add_points(frame, more);
  frames.push_back(frame);
}

void TrajectoryReader::Open::add_points(FramePlace& frame, std::int64_t more) const {
  if (more > any - frame.particles)
    throw InputError(file.where("/VTKHDF/NumberOfPoints"), "number of points of a frame",
                     "more than 2^63", "less");
  frame.particles += more;
}

/// Frames are counted by NSteps; one without a time is not complete.
void TrajectoryReader::Open::read_steps() {
  if (!file.has("/VTKHDF/Steps")) {
    read_single_frame();
    return;
  }
  const std::string steps = "/VTKHDF/Steps/";
  std::int64_t count = file.integer_attribute("/VTKHDF/Steps", "NSteps");
  if (count < 0)
    throw InputError(file.where("/VTKHDF/Steps") + ": attribute NSteps", "number of frames",
                     std::to_string(count), "≥ 0");
  const hdf5::InputDataset values = file.dataset(steps + "Values", hdf5::Kind::real, 1);
  count = std::min(count, values.rows());

  std::vector<double> times(static_cast<std::size_t>(count));
  values.read(0, count, times.data());
  const auto parts = file.integers(steps + "NumberOfParts", count, 1, any);
  const auto part_offsets = file.integers(steps + "PartOffsets", count, 0, any);
  const auto point_offsets = file.integers(steps + "PointOffsets", count, 0, any);
  const std::string points_name = "/VTKHDF/NumberOfPoints";
  const std::int64_t all_parts = file.dataset(points_name, hdf5::Kind::integer, 1).rows();
  const auto points = file.integers(points_name, all_parts, 0, any);

  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!std::isfinite(times[k]))
      throw InputError(element(values.where(), k), "time of the frame", to_text(times[k]),
                       "finite");
    if (parts[k] > all_parts || part_offsets[k] > all_parts - parts[k])
      throw InputError(element(file.where(steps + "NumberOfParts"), k), "parts of the frame",
                       std::to_string(parts[k]) + " from " + std::to_string(part_offsets[k]),
                       "within the " + std::to_string(all_parts) + " of NumberOfPoints");
    FramePlace frame{times[k], 0, point_offsets[k]};
    for (std::int64_t part = 0; part < parts[k]; ++part)
      add_points(frame, points[static_cast<std::size_t>(part_offsets[k] + part)]);
    frames.push_back(frame);
  }
}

void TrajectoryReader::Open::open_array(const ParticleArray& array) {
  const std::string name = array.name;
  const auto count = static_cast<std::int64_t>(frames.size());
  const std::string offsets_name = "/VTKHDF/Steps/PointDataOffsets/" + name;
  if (is_point_data(array) && file.has(offsets_name))
    offsets[name] = file.integers(offsets_name, count, 0, any);
  const hdf5::Kind kind = array.integer ? hdf5::Kind::integer : hdf5::Kind::real;
  const hdf5::InputDataset& data =
      arrays.emplace(name, file.dataset(array.path, kind, array.components, stored_rows))
          .first->second;
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t first = first_row(name, k), particles = at(k).particles;
    if (particles > data.rows() || first > data.rows() - particles)
      throw InputError(data.where(), "rows of frame " + std::to_string(k),
                       std::to_string(particles) + " from " + std::to_string(first),
                       "within the " + std::to_string(data.rows()) + " rows of the dataset");
  }
}

/// The number of particles must have bytes behind it in an array of real numbers; arrays of that
/// length may then be left to their fill value.
void TrajectoryReader::Open::open_arrays() {
  for_each_array([this](const ParticleArray& array) {
    if (!array.integer) stored_rows = std::max(stored_rows, file.stored_rows(array.path));
  });
  for_each_array([this](const ParticleArray& array) { open_array(array); });
  const std::int64_t points = arrays.at("position").rows();
  if (!file.has("/VTKHDF/Steps") && points != frames[0].particles)
    throw InputError(file.where("/VTKHDF/Points"), "rows without a group Steps",
                     std::to_string(points),
                     std::to_string(frames[0].particles) + ", the sum of NumberOfPoints");
}

void TrajectoryReader::Open::read_firn() {
  const std::string firn = "/firn";
  if (!file.has(firn)) return;
  const std::string format = file.text_attribute(firn, "format");
  if (format != trajectory_format)
    throw InputError(file.where(firn) + ": attribute format", "format", one_line(format, 80),
                     std::string(trajectory_format));
  const std::int64_t version = file.integer_attribute(firn, "version");
  if (version != trajectory_version)
    throw InputError(file.where(firn) + ": attribute version", "version", std::to_string(version),
                     std::to_string(trajectory_version));
  TrajectoryInfo found;
  found.solver = file.text_attribute(firn, "solver");
  const std::string precision = file.text_attribute(firn, "precision");
  if (precision != "double" && precision != "float")
    throw InputError(file.where(firn) + ": attribute precision", "precision",
                     one_line(precision, 80), "double, float");
  found.precision = precision == "float" ? Precision::float32 : Precision::float64;
  found.threads = static_cast<int>(
      std::clamp<std::int64_t>(file.integer_attribute(firn, "threads"), 0, 1 << 20));
  found.firn_version = file.text_attribute(firn, "firn_version");
  found.processor = file.text_attribute(firn, "processor");
  found.scene = file.text_attribute(firn, "scene");
  info = found;

  const auto count = static_cast<std::int64_t>(frames.size());
  if (file.has("/firn/steps")) steps = file.integers("/firn/steps", count, 0, any);
  if (file.has("/firn/restart")) {
    restart = file.dataset("/firn/restart", hdf5::Kind::integer, 0);
    if (restart->rows() < count)
      throw InputError(restart->where(), "number of rows", std::to_string(restart->rows()),
                       "at least the " + std::to_string(count) + " frames");
  }
  if (!file.has("/firn/diagnostics")) return;
  rows = file.integer_attribute("/firn/diagnostics", "rows");
  for (const DiagnosticsColumn& column : diagnostics_columns) {
    if (column.optional && !file.has(std::string("/firn/diagnostics/") + column.name)) continue;
    const hdf5::InputDataset data =
        file.dataset(std::string("/firn/diagnostics/") + column.name,
                     column.integer ? hdf5::Kind::integer : hdf5::Kind::real, column.components);
    if (rows < 0 || rows > data.rows())
      throw InputError(file.where("/firn/diagnostics") + ": attribute rows", "number of rows",
                       std::to_string(rows),
                       "0 … " + std::to_string(data.rows()) + ", the length of " + column.name);
  }
}

std::vector<std::int32_t> TrajectoryReader::Open::read_small(const std::string& name,
                                                             std::int64_t frame) const {
  std::vector<std::int64_t> values(static_cast<std::size_t>(at(frame).particles));
  read(name, frame, values.data());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i] < 0 || values[i] > std::numeric_limits<std::int32_t>::max())
      throw InputError(arrays.at(name).where() + ", frame " + std::to_string(frame) +
                           ", particle " + std::to_string(i),
                       name, std::to_string(values[i]), "0 … 2147483647");
  return {values.begin(), values.end()};
}

std::int64_t TrajectoryReader::Open::first_row(const std::string& name, std::int64_t frame) const {
  const auto found = offsets.find(name);
  return found == offsets.end() ? at(frame).first : found->second[static_cast<std::size_t>(frame)];
}

const FramePlace& TrajectoryReader::Open::at(std::int64_t frame) const {
  const auto count = static_cast<std::int64_t>(frames.size());
  if (frame < 0 || frame >= count)
    throw InputError(
        file.path().string(), "frame", std::to_string(frame),
        count == 0 ? "none, the file has no frames" : "0 … " + std::to_string(count - 1));
  return frames[static_cast<std::size_t>(frame)];
}

}  // namespace firn
