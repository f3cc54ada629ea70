// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Writes a trajectory so that it survives `kill -9` at any moment.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "firn/state.hpp"
#include "io/trajectory/diagnostics_row.hpp"
#include "io/trajectory/format.hpp"

namespace firn {

class TrajectoryFile;
class TrajectoryReader;
struct TrajectorySize;

/// One output file of a run.
///
/// Everything is laid out at full size beforehand, so that adding a frame never
/// moves anything in the file: values first, counts after them, each flushed
/// before the next. The file is created as OUTPUT.partial and takes OUTPUT's
/// place with the first complete frame; until then whatever stood there is
/// untouched. When the room is used up, a larger OUTPUT.partial is filled and
/// renamed the same way.
class TrajectoryWriter {
 public:
  /// `frames` and `rows` are what the run will need, as far as is known: the
  /// room that is reserved on the disk. Throws InputError if the file cannot be
  /// created or the disk has no room; nothing is left behind then.
  TrajectoryWriter(std::filesystem::path output, TrajectoryInfo info, std::int64_t particles,
                   std::size_t restart_size, std::int64_t frames, std::int64_t rows);

  /// Removes OUTPUT.partial if no frame was completed.
  ~TrajectoryWriter();
  TrajectoryWriter(const TrajectoryWriter&) = delete;
  TrajectoryWriter& operator=(const TrajectoryWriter&) = delete;

  /// Before the first frame of one's own: takes over the listed frames of
  /// another trajectory and its first `rows` diagnostics rows.
  void copy_from(const TrajectoryReader& source, const std::vector<std::int64_t>& frames,
                 std::int64_t rows);

  /// The row of the step just made. Kept in memory until the next frame: rows
  /// and frames on the disk always belong together.
  void add_row(const DiagnosticsRow& row);

  /// Drops the rows waiting that belong to steps after `step`.
  void forget_rows_after(std::int64_t step);

  /// Adds the rows waiting and then the frame. When it returns, both are in the
  /// file whatever happens to this process. `restart` has restart_size bytes.
  /// Throws SimulationError if a value is not finite in the file's precision
  /// (nothing is added then), OutputError if the file cannot be written.
  void write_frame(const State& state, std::span<const std::byte> restart);

  /// Gives back the room that was not used, if there is any (the file is copied
  /// to one of the exact size), and closes the file. A copy that fails is no
  /// error: the longer file is complete, too.
  void finish();

  std::int64_t frames() const { return frames_; }  ///< complete in the file
  std::int64_t rows() const { return rows_; }      ///< complete in the file
  const std::filesystem::path& path() const { return output_; }

 private:
  void resolve_output();
  std::filesystem::path partial_path() const;
  void append_frame(const State& state, std::span<const std::byte> restart);
  void make_room();
  void move_to_file_of(const TrajectorySize& size);
  void copy_complete_part(const TrajectoryReader& from, TrajectoryFile& to) const;
  void publish();

  std::filesystem::path output_;
  std::filesystem::path current_;  ///< where file_ is: OUTPUT.partial or, once published, OUTPUT
  TrajectoryInfo info_;
  std::unique_ptr<TrajectoryFile> file_;
  std::vector<DiagnosticsRow> waiting_;
  std::int64_t frames_ = 0, rows_ = 0;  ///< complete in the file
};

}  // namespace firn
