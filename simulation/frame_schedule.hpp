// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// When a run writes a frame and when it ends.

#include <cstdint>
#include <optional>

namespace firn {

/// Depends only on step number and time, so that a resumed run decides as the
/// uninterrupted one did.
///
/// A time that n additions of Δt reached carries n roundings, and Δt itself is
/// rounded: (n+1)·2⁻⁵³ relative. A moment counts as reached within twice that,
/// so that 10⁴ steps of 1e-4 s end at 1 s and not one step later.
class FrameSchedule {
 public:
  /// `end` [s]; `steps`: end after so many steps if that is earlier;
  /// `frames_per_second` > 0.
  FrameSchedule(double end, std::optional<std::int64_t> steps, double frames_per_second);

  /// Whether the run is over with n = `step` steps made and t = `time`.
  bool finished(std::int64_t step, double time) const;

  /// Whether step n, from `previous_time` to `time`, was the first at or past
  /// some k/frames_per_second.
  bool frame_due(std::int64_t step, double previous_time, double time) const;

  double end() const { return end_; }
  std::optional<std::int64_t> steps() const { return steps_; }

  /// What a run from (step, time) still has to write, the last state's frame
  /// included; `has_frame`: the present state is written already. Exact for a
  /// fixed Δt and steps few enough to be counted one by one; else an upper bound
  /// of the frames, and the rows for steps of about `dt`.
  struct Need {
    std::int64_t frames = 0, rows = 0;
  };
  Need need(std::int64_t step, double time, double dt, bool fixed_dt, bool has_frame) const;

 private:
  double frames_passed(std::int64_t step, double time) const;

  double end_;
  std::optional<std::int64_t> steps_;
  double frames_per_second_;
};

}  // namespace firn
