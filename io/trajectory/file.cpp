// SPDX-License-Identifier: BSD-3-Clause
#include "io/trajectory/file.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <vector>

#include "firn/error.hpp"
#include "io/hdf5/write.hpp"

namespace firn {

TrajectoryFile::TrajectoryFile(std::filesystem::path path, const TrajectoryInfo& info,
                               const TrajectorySize& size)
    : path_(std::move(path)), size_(size), precision_(info.precision) {
  const hdf5::Id access = hdf5::file_access();
  file_ = hdf5::Id(hdf5::written(H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()),
                                 path_.string()),
                   H5Fclose);
  try {
    create(info);
  } catch (...) {
    file_ = {};
    unlink(path_.c_str());
    throw;
  }
}

void TrajectoryFile::create(const TrajectoryInfo& info) {
  create_trajectory_layout(file_.get(), info, size_);
  flush();
  reserve();
}

/// The file has its final length but holes: the disk's blocks are taken now,
/// so that it cannot fill up in the middle of a frame.
void TrajectoryFile::reserve() {
  void* handle = nullptr;
  hsize_t bytes = 0;
  hdf5::written(H5Fget_vfd_handle(file_.get(), H5P_DEFAULT, &handle), path_.string());
  hdf5::written(H5Fget_filesize(file_.get(), &bytes), path_.string());
  const int error = posix_fallocate(*static_cast<const int*>(handle), 0, static_cast<off_t>(bytes));
  if (error != 0)
    throw OutputError(path_.string() + ": cannot reserve " + std::to_string(bytes) +
                      " bytes: " + std::strerror(error));
}

hid_t TrajectoryFile::slots(const std::string& name) {
  hdf5::Id& dataset = slots_[name];
  if (!dataset)
    dataset =
        hdf5::Id(hdf5::written(H5Dopen2(file_.get(), name.c_str(), H5P_DEFAULT), name), H5Dclose);
  return dataset.get();
}

void TrajectoryFile::flush() {
  hdf5::written(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL), path_.string());
}

void TrajectoryFile::sync() {
  void* handle = nullptr;
  hdf5::written(H5Fget_vfd_handle(file_.get(), H5P_DEFAULT, &handle), path_.string());
  if (fsync(*static_cast<const int*>(handle)) != 0)
    throw OutputError(path_.string() + ": cannot be written: " + std::strerror(errno));
}

void TrajectoryFile::count_rows(std::int64_t rows) {
  hdf5::rewrite_integer(file_.get(), "/firn/diagnostics", "rows", rows);
  flush();
}

/// NSteps and the length of Steps/Values have to change together: VTK reads all
/// of Values into NSteps places. They do: HDF5 keeps both in headers that were
/// created one right after the other (create_steps), and its accumulator makes
/// one write of neighbours that are flushed together. The kill test would see
/// two.
void TrajectoryFile::count_frames(std::int64_t frames, double time) {
  hdf5::rewrite_integer(file_.get(), "/VTKHDF/Steps", "NSteps", frames);
  const std::string name = "/VTKHDF/Steps/Values";
  const hsize_t length = static_cast<hsize_t>(frames);
  hdf5::written(H5Dset_extent(slots(name), &length), name);
  hdf5::write_rows(slots(name), name, frames - 1, 1, H5T_NATIVE_DOUBLE, &time);
  flush();
}

void TrajectoryFile::write_rows(std::int64_t first, std::span<const DiagnosticsRow> rows) {
  std::vector<double> values;
  for (std::size_t c = 0; c < diagnostics_columns.size(); ++c) {
    const DiagnosticsColumn& column = diagnostics_columns[c];
    values.resize(rows.size() * static_cast<std::size_t>(column.components));
    for (std::size_t r = 0; r < rows.size(); ++r)
      get_column(rows[r], c, &values[r * static_cast<std::size_t>(column.components)]);
    const std::string name = std::string("/firn/diagnostics/") + column.name;
    hdf5::write_rows(slots(name), name, first, static_cast<std::int64_t>(rows.size()),
                     H5T_NATIVE_DOUBLE, values.data());
  }
}

void TrajectoryFile::write_frame(std::int64_t frame, const State& state,
                                 std::span<const std::byte> restart) {
  for_each_array(
      [&]<class T>(const ParticleArray& array, const std::vector<T>& values) {
        if constexpr (std::is_integral_v<T>)
          hdf5::write_rows(slots(array.path), array.path, frame * size_.particles, size_.particles,
                           sizeof(T) == 8 ? H5T_NATIVE_INT64 : H5T_NATIVE_INT32, values.data());
        else if (precision_ == Precision::float64)
          write_array<double>(array, frame, values);
        else
          write_array<float>(array, frame, values);
      },
      state.particles);
  hdf5::write_rows(slots("/firn/steps"), "/firn/steps", frame, 1, H5T_NATIVE_INT64, &state.step);
  if (size_.restart_size > 0)
    hdf5::write_rows(slots("/firn/restart"), "/firn/restart", frame, 1, H5T_NATIVE_UINT8,
                     restart.data());
}

/// In slices, so that a buffer of a few megabytes serves any number of particles.
template <class Real, class T>
void TrajectoryFile::write_array(const ParticleArray& array, std::int64_t frame,
                                 const std::vector<T>& values) {
  constexpr std::int64_t slice = 1 << 16;
  std::vector<Real> buffer;
  for (std::int64_t begin = 0; begin < size_.particles; begin += slice) {
    const std::int64_t end = std::min(begin + slice, size_.particles);
    buffer.clear();
    for (std::int64_t i = begin; i < end; ++i) {
      for (int c = 0; c < components_of<T>; ++c) {
        const Real value = static_cast<Real>(component(values[static_cast<std::size_t>(i)], c));
        if (!std::isfinite(value))
          throw SimulationError(Stage::positions, SimulationError::Subject::particle, i,
                                std::string(array.path) + " is not finite");
        buffer.push_back(value);
      }
    }
    hdf5::write_rows(slots(array.path), array.path, frame * size_.particles + begin, end - begin,
                     sizeof(Real) == 8 ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT, buffer.data());
  }
}

}  // namespace firn
