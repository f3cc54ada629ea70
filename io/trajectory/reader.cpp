// SPDX-License-Identifier: BSD-3-Clause
#include "io/trajectory/reader.hpp"

#include <limits>
#include <string>

#include "firn/error.hpp"
#include "firn/memory.hpp"
#include "io/trajectory/check_particles.hpp"
#include "io/trajectory/open.hpp"

namespace firn {

TrajectoryReader::TrajectoryReader(std::filesystem::path path)
    : open_(std::make_unique<Open>(path)) {}

TrajectoryReader::~TrajectoryReader() = default;
TrajectoryReader::TrajectoryReader(TrajectoryReader&&) noexcept = default;

const std::filesystem::path& TrajectoryReader::path() const { return open_->file.path(); }

std::int64_t TrajectoryReader::frames() const {
  return static_cast<std::int64_t>(open_->frames.size());
}

std::int64_t TrajectoryReader::particles(std::int64_t frame) const {
  return open_->at(frame).particles;
}

double TrajectoryReader::time(std::int64_t frame) const { return open_->at(frame).time; }

std::optional<std::int64_t> TrajectoryReader::step(std::int64_t frame) const {
  open_->at(frame);
  if (open_->steps.empty()) return std::nullopt;
  return open_->steps[static_cast<std::size_t>(frame)];
}

State TrajectoryReader::read_frame_unchecked(std::int64_t frame) const {
  State state;
  state.time = time(frame);
  state.step = step(frame).value_or(0);
  Particles& p = state.particles;
  p.resize(static_cast<std::size_t>(particles(frame)));
  if (p.size() == 0) return state;
  for_each_array(
      [&]<class T>(const ParticleArray& array, std::vector<T>& values) {
        if constexpr (std::is_same_v<T, std::int32_t>)
          values = open_->read_small(array.name, frame);
        else if constexpr (std::is_arithmetic_v<T>)
          open_->read(array.name, frame, values.data());
        else
          open_->read(array.name, frame, values[0].data());
        if constexpr (std::is_same_v<T, Mat3>)  // the file is row-major, Mat3 column-major
          for (Mat3& matrix : values) matrix.transposeInPlace();
      },
      p);
  return state;
}

State TrajectoryReader::read_frame(std::int64_t frame) const {
  State state = read_frame_unchecked(frame);
  check_particles(state.particles, path().string() + ": frame " + std::to_string(frame));
  return state;
}

std::vector<std::byte> TrajectoryReader::restart(std::int64_t frame) const {
  open_->at(frame);
  if (!open_->restart) return {};
  std::vector<std::byte> bytes(static_cast<std::size_t>(open_->restart->components()));
  open_->restart->read(frame, 1, bytes.data());
  return bytes;
}

const std::optional<TrajectoryInfo>& TrajectoryReader::info() const { return open_->info; }

std::int64_t TrajectoryReader::rows() const { return open_->rows; }

std::vector<DiagnosticsRow> TrajectoryReader::diagnostics() const {
  std::vector<DiagnosticsRow> rows(static_cast<std::size_t>(open_->rows));
  std::vector<double> values;
  for (std::size_t c = 0; c < diagnostics_columns.size() && !rows.empty(); ++c) {
    const DiagnosticsColumn& column = diagnostics_columns[c];
    const std::string name = std::string("/firn/diagnostics/") + column.name;
    if (column.optional && !open_->file.has(name)) continue;
    const auto components = static_cast<std::size_t>(column.components);
    values.resize(rows.size() * components);
    open_->file
        .dataset(name, column.integer ? hdf5::Kind::integer : hdf5::Kind::real, column.components)
        .read(0, open_->rows, values.data());
    for (std::size_t r = 0; r < rows.size(); ++r) set_column(rows[r], c, &values[r * components]);
  }
  return rows;
}

Particles read_last_frame(const std::filesystem::path& path) {
  const TrajectoryReader reader(path);
  if (reader.frames() == 0)
    throw InputError(path.string() + ": /VTKHDF/Steps", "number of frames", "0", "at least 1");
  const std::int64_t last = reader.frames() - 1;
  require_memory(path.string(), static_cast<double>(reader.particles(last)),
                 state_bytes_per_particle);
  return reader.read_frame(last).particles;
}

}  // namespace firn
