// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// One run of simulate(): the clock, the state to fall back to, the file.
/// run_start.cpp holds what happens before the first step, simulate.cpp the rest.

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "io/trajectory/writer.hpp"
#include "simulation/frame_schedule.hpp"
#include "simulation/last_good_state.hpp"
#include "simulation/resume.hpp"
#include "simulation/simulate.hpp"

namespace firn {

/// End time, number of steps and frame rate from the scene and the options over it. Throws
/// InputError.
FrameSchedule schedule_of(const Scene& scene, const RunOptions& options);

class Run {
 public:
  Run(const Scene& scene, Solver& solver, const RunOptions& options)
      : scene_(scene), solver_(solver), options_(options), schedule_(schedule_of(scene, options)) {}

  RunResult operator()();

 private:
  void require_safe_output() const;
  void start();
  void load_resumed(const Resume& resume);
  void open_output(const Resume* resume);
  FrameSchedule::Need room_needed(bool has_frame);
  void run_to_the_end();
  void advance();
  void step(double dt);
  bool may_retry() const { return scene_.semi_implicit() && scene_.time.adaptive; }
  void return_to_last_good_state();
  void write_frame();
  void fail(const std::string& message);
  void write_last_good_state();
  void report_step() const;
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  }

  const Scene& scene_;
  Solver& solver_;
  const RunOptions& options_;
  const FrameSchedule schedule_;

  std::int64_t step_ = 0;  ///< n
  double time_ = 0;        ///< tⁿ [s]
  LastGoodState last_good_;
  /// Why the solver no longer holds the state at (step_, time_); empty: it does.
  std::string lost_;

  std::unique_ptr<TrajectoryWriter> writer_;
  std::int64_t frames_ = 0;
  std::int64_t last_frame_step_ = -1;
  double last_frame_time_ = 0;

  std::int64_t first_step_ = 0;
  double first_time_ = 0;
  std::chrono::steady_clock::time_point began_;
  RunResult result_;
};

}  // namespace firn
