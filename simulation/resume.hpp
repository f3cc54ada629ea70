// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Where a resumed run starts.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "firn/scene.hpp"
#include "firn/solver.hpp"
#include "io/trajectory/reader.hpp"
#include "simulation/frame_schedule.hpp"
#include "simulation/last_good_state.hpp"

namespace firn {

/// One frame of a trajectory, and what of the file an uninterrupted run would
/// have written up to there.
class Resume {
 public:
  /// Throws InputError unless the file comes from this scene, solver and
  /// precision, and holds that frame (the last one by default) with all rows
  /// up to it.
  Resume(const std::filesystem::path& path, std::optional<std::int64_t> frame, const Scene& scene,
         const Solver& solver);

  const TrajectoryReader& file() const { return file_; }
  /// Throws InputError if the solver's restart data or a material does not fit.
  LastGoodState read(const Scene& scene) const;

  std::int64_t step() const { return step_; }
  double time() const { return time_; }

  /// False if the frame resumed from is there only because a run stopped there.
  bool keeps_its_frame(const FrameSchedule& schedule) const;

  /// The frames up to the one resumed from, with or without it.
  std::vector<std::int64_t> frames_to_keep(const FrameSchedule& schedule) const;

 private:
  TrajectoryReader file_;
  std::int64_t frame_ = 0, step_ = 0;
  double time_ = 0, previous_time_ = 0;
};

}  // namespace firn
