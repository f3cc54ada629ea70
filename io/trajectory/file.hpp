// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The file of a TrajectoryWriter: laid out at full size once, then filled slot
/// by slot.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "firn/state.hpp"
#include "io/hdf5/id.hpp"
#include "io/trajectory/diagnostics_row.hpp"
#include "io/trajectory/format.hpp"
#include "io/trajectory/layout.hpp"

namespace firn {

class TrajectoryFile {
 public:
  /// Creates the file and reserves every byte of it on the disk. Throws
  /// OutputError, as all of these do, and leaves no file behind then.
  TrajectoryFile(std::filesystem::path path, const TrajectoryInfo& info,
                 const TrajectorySize& size);

  /// Values into slots that are not counted yet. A particle quantity that is
  /// not finite in the file's precision is a SimulationError.
  void write_rows(std::int64_t first, std::span<const DiagnosticsRow> rows);
  void write_frame(std::int64_t frame, const State& state, std::span<const std::byte> restart);

  /// Flushes everything written so far to the file, in an order that HDF5 chooses.
  void flush();

  /// The counts, each in one write to the file.
  void count_rows(std::int64_t rows);
  void count_frames(std::int64_t frames, double time);

  /// Forces the file to the disk, before it replaces another.
  void sync();

  const TrajectorySize& size() const { return size_; }

 private:
  void create(const TrajectoryInfo& info);
  void reserve();
  hid_t slots(const std::string& name);

  template <class Real, class T>
  void write_array(const ParticleArray& array, std::int64_t frame, const std::vector<T>& values);

  std::filesystem::path path_;
  TrajectorySize size_;
  Precision precision_;
  hdf5::Id file_;
  std::map<std::string, hdf5::Id> slots_;  ///< datasets that are filled as the run goes
};

}  // namespace firn
