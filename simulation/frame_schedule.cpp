// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/frame_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace firn {

namespace {

/// (n+1)·2⁻⁵²·t
double rounding_guard(std::int64_t step, double time) {
  return (static_cast<double>(step) + 1) * std::numeric_limits<double>::epsilon() * time;
}

}  // namespace

FrameSchedule::FrameSchedule(double end, std::optional<std::int64_t> steps,
                             double frames_per_second)
    : end_(end), steps_(steps), frames_per_second_(frames_per_second) {}

bool FrameSchedule::finished(std::int64_t step, double time) const {
  return (steps_ && step >= *steps_) || time + rounding_guard(step, time) >= end_;
}

/// The largest k with k/frames_per_second ≤ t, within the guard. As a double:
/// it may be larger than any integer type holds.
double FrameSchedule::frames_passed(std::int64_t step, double time) const {
  const double t = time + rounding_guard(step, time);
  double k = std::floor(t * frames_per_second_);
  if ((k + 1) / frames_per_second_ <= t) k += 1;  // the product was rounded down
  if (k / frames_per_second_ > t) k -= 1;         // … or up
  return k;
}

bool FrameSchedule::frame_due(std::int64_t step, double previous_time, double time) const {
  return frames_passed(step, time) > frames_passed(step - 1, previous_time);
}

FrameSchedule::Need FrameSchedule::need(std::int64_t step, double time, double dt, bool fixed_dt,
                                        bool has_frame) const {
  constexpr double countable = 1e7;  // a tenth of a second
  constexpr double most = 1e15;      // more than any disk holds; casts stay defined
  double steps_left = std::max(0.0, std::ceil((end_ - time) / dt) + 1);
  if (steps_) steps_left = std::min(steps_left, std::max(0.0, static_cast<double>(*steps_ - step)));

  if (fixed_dt && steps_left <= countable) {
    Need need;
    while (!finished(step, time)) {
      const double previous = time;
      time += dt;
      ++step;
      ++need.rows;
      has_frame = frame_due(step, previous, time);
      if (has_frame) ++need.frames;
    }
    if (!has_frame) ++need.frames;
    return need;
  }
  const double marks_left = std::floor(std::max(0.0, end_ - time) * frames_per_second_) + 2;
  const double frames = std::min(marks_left, fixed_dt || steps_ ? steps_left + 1 : most);
  return {static_cast<std::int64_t>(std::min(frames, most)),
          static_cast<std::int64_t>(std::min(steps_left, most))};
}

}  // namespace firn
