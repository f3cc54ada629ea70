// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Reads trajectories, also ones that other programs wrote.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "firn/state.hpp"
#include "io/trajectory/diagnostics_row.hpp"
#include "io/trajectory/format.hpp"

namespace firn {

/// One trajectory, opened for reading. The file is not trusted: every shape,
/// type and count is checked, and InputError names the dataset. Needed are
/// Points and the seven arrays of PointData, as 32- or 64-bit numbers; `/firn`
/// may be missing, and Steps, too, where there is one frame. The number of particles may differ
/// between frames.
class TrajectoryReader {
 public:
  explicit TrajectoryReader(std::filesystem::path path);
  ~TrajectoryReader();
  TrajectoryReader(TrajectoryReader&&) noexcept;

  const std::filesystem::path& path() const;

  std::int64_t frames() const;
  std::int64_t particles(std::int64_t frame) const;
  double time(std::int64_t frame) const;  ///< [s]
  /// Steps completed at that frame; none if the file does not say (no /firn/steps).
  std::optional<std::int64_t> step(std::int64_t frame) const;

  /// Time, step (0 if the file does not say) and particles of a frame, all of
  /// them finite, masses > 0, volumes ≥ 0, materials ≥ 0, ids unique: a state
  /// from which a simulation can start.
  State read_frame(std::int64_t frame) const;

  /// The same without judging the values, for comparisons.
  State read_frame_unchecked(std::int64_t frame) const;

  /// What Solver::load_restart() needs at that frame; empty if there is none.
  std::vector<std::byte> restart(std::int64_t frame) const;

  /// The attributes of /firn; none if the file has no such group.
  const std::optional<TrajectoryInfo>& info() const;

  /// Rows of /firn/diagnostics, one per step.
  std::int64_t rows() const;
  std::vector<DiagnosticsRow> diagnostics() const;

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

/// The last frame, for a body of shape `particles`. Its material indices belong
/// to the scene that wrote the file; the body states its own material.
Particles read_last_frame(const std::filesystem::path& path);

}  // namespace firn
