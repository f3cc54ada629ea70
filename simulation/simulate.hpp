// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Runs a scene on a solver: frames, diagnostics, resuming, and an orderly end
/// whatever happens.

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firn/scene.hpp"
#include "firn/solver.hpp"
#include "io/trajectory/diagnostics_row.hpp"

namespace firn {

/// After every step.
struct Progress {
  std::int64_t step = 0;                        ///< steps completed, counted from t = 0
  double time = 0;                              ///< [s]
  double end = 0;                               ///< where the run will end [s]
  double fraction = 0;                          ///< of this run that is done, in [0, 1]
  std::int64_t frames = 0;                      ///< in the file
  std::int64_t particles = 0;                   ///< N
  double seconds = 0;                           ///< wall time since the first step of this run
  double steps_per_second = 0;                  ///< over this run, output included
  const DiagnosticsRow* diagnostics = nullptr;  ///< of this step; valid during the call
};

/// After every frame, once it is safely in the file.
struct FrameReport {
  std::int64_t frame = 0;  ///< its number in the file
  std::int64_t step = 0;
  double time = 0;  ///< [s]
};

/// A step that failed and is tried again with half the Δt.
struct Retry {
  std::int64_t step = 0;  ///< steps completed before it
  double time = 0;        ///< [s]
  int attempt = 0;        ///< 1 … 10
  double dt = 0;          ///< that failed [s]
  double next_dt = 0;     ///< that is tried now [s]
  std::string message;    ///< why it failed
};

struct RunOptions {
  std::filesystem::path output;       ///< empty: no file is written
  std::optional<std::int64_t> steps;  ///< stop at step N, counted from t = 0; 0: initial state
  std::optional<double> until;        ///< instead of Scene::time.end [s]
  std::optional<double> frames_per_second;  ///< instead of the scene's [1/s]

  /// Continue from a frame of this file: the last one unless `resume_frame` is
  /// given. The file may be `output` itself. It must come from the same scene,
  /// solver and precision. What is in `output` afterwards equals an
  /// uninterrupted run bit for bit: frames after the one resumed from, and one
  /// that is there only because a run stopped there, are not taken over.
  std::filesystem::path resume;
  std::optional<std::int64_t> resume_frame;

  /// Files that this run reads beside Scene::files and `resume`, such as a solver's library:
  /// `output` must be none of them.
  std::vector<std::string> inputs;
  bool force = false;  ///< replace an existing `output` even if it is no trajectory of ours

  int threads = 1;        ///< for the file's attribute
  std::string processor;  ///< likewise

  const std::atomic<bool>* stop = nullptr;  ///< set (by Ctrl-C): end after the step under way

  std::function<void(const Progress&)> on_step;
  std::function<void(const FrameReport&)> on_frame;
  std::function<void(const Retry&)> on_retry;
};

enum class RunStatus { completed, interrupted, failed };

struct RunResult {
  RunStatus status = RunStatus::completed;
  std::string message;         ///< one line; empty when completed
  std::int64_t particles = 0;  ///< N
  std::int64_t step = 0;       ///< of the last good state
  double time = 0;             ///< of the last good state [s]
  std::int64_t frames = 0;     ///< in the file, or that it would have
  std::int64_t steps_run = 0;  ///< by this run, without retries
  /// How often each TimeStepBound decided Δt in this run, in the order of the enumeration.
  std::array<std::int64_t, 4> steps_by_bound{};
  std::int64_t retries = 0;
  double worst_residual = 0;          ///< largest StepReport::solver_residual of this run
  std::int64_t indefinite_steps = 0;  ///< steps whose semi-implicit system was indefinite
  double seconds = 0;                 ///< wall time from the first step on
  DiagnosticsRow diagnostics;         ///< of the last good state

  int exit_status() const;  ///< 0, 130 or 3
};

/// Runs `scene` on `solver` until the end, the flag `stop`, or a failure.
///
/// Frames: the initial state; the state after the first step at or past each
/// k/frames_per_second; the last state. The run ends with the first step at or
/// past the end time. "At" allows for the rounding of a time that n additions of
/// Δt reached: n+1 roundings of relative size eps = 2⁻⁵², so that 10⁴ steps of
/// 1e-4 s end at 1 s and not one step later.
///
/// Throws InputError, before anything is computed or written, if the output is one of
/// the run's inputs or a foreign file, the solver does not support the scene, the file
/// cannot be created or resumed from, or the disk has no room. A SimulationError, non-finite
/// diagnostics or a disk error later ends the run as `failed` with the last good state written.
/// Scenes that are semi-implicit and adaptive try a failed step again with half the Δt, at most 10
/// times.
RunResult simulate(const Scene& scene, Solver& solver, const RunOptions& options);

}  // namespace firn
