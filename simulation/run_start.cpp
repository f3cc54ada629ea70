// SPDX-License-Identifier: BSD-3-Clause
/// The part of a run before its first step.

#include <algorithm>
#include <cmath>
#include <optional>
#include <system_error>

#include "firn/build_info.hpp"
#include "firn/error.hpp"
#include "io/output_error.hpp"
#include "io/output_path.hpp"
#include "io/trajectory/layout.hpp"
#include "simulation/run.hpp"

namespace firn {

namespace {

void require_positive(const char* option, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw InputError(option, "value", to_text(value), "> 0, finite");
}

}  // namespace

FrameSchedule schedule_of(const Scene& scene, const RunOptions& options) {
  const double end = options.until.value_or(scene.time.end);
  const double rate = options.frames_per_second.value_or(scene.time.frames_per_second);
  if (!(end >= 0) || !std::isfinite(end))
    throw InputError("--until", "end time", to_text(end), "≥ 0 s, finite");
  if (options.steps && *options.steps < 0)
    throw InputError("--steps", "number of steps", std::to_string(*options.steps), "≥ 0");
  require_positive("--frames-per-second", rate);
  return FrameSchedule(end, options.steps, rate);
}

/// The file resumed from may be continued in its place, unless the scene reads it, too.
void Run::require_safe_output() const {
  std::vector<std::string> inputs = options_.inputs;
  inputs.insert(inputs.end(), scene_.files.begin(), scene_.files.end());
  require_no_input(options_.output, inputs);
  if (!options_.resume.empty()) {
    std::error_code error;
    if (std::filesystem::equivalent(options_.output, options_.resume, error)) return;
    require_no_input(options_.output, {options_.resume.string()});
  }
  require_replaceable(options_.output, OutputKind::trajectory, options_.force);
}

/// Everything that may refuse the input comes before the first byte of output.
void Run::start() {
  if (!options_.output.empty()) require_safe_output();
  std::optional<Resume> resume;
  if (options_.resume.empty()) {
    last_good_.state = initial_state(scene_);
    last_good_.load_into(solver_, scene_);
  } else {
    resume.emplace(options_.resume, options_.resume_frame, scene_, solver_);
    load_resumed(*resume);
  }
  first_step_ = step_;
  first_time_ = time_;
  result_.particles = static_cast<std::int64_t>(last_good_.state.particles.size());
  began_ = std::chrono::steady_clock::now();
  try {
    if (!options_.output.empty()) open_output(resume ? &*resume : nullptr);
    if (!resume) write_frame();
  } catch (const OutputError& error) {
    throw InputError(error.what());
  }
}

void Run::load_resumed(const Resume& resume) {
  last_good_ = resume.read(scene_);
  solver_.load(scene_, last_good_.state);
  if (solver_.restart_size() != last_good_.restart.size())
    throw InputError(
        options_.resume.string() + ": /firn/restart", "bytes per frame",
        std::to_string(last_good_.restart.size()),
        std::to_string(solver_.restart_size()) + ", as solver " + solver_.traits().name + " needs");
  if (!last_good_.restart.empty()) solver_.load_restart(last_good_.restart);
  step_ = resume.step();
  time_ = resume.time();
}

void Run::open_output(const Resume* resume) {
  const SolverTraits& traits = solver_.traits();
  const TrajectoryInfo info{traits.name,          traits.precision,   options_.threads,
                            build_info().version, options_.processor, scene_.toml};
  std::vector<std::int64_t> kept;
  if (resume != nullptr) kept = resume->frames_to_keep(schedule_);
  const bool has_frame = resume == nullptr || resume->keeps_its_frame(schedule_);
  FrameSchedule::Need need = room_needed(has_frame);
  need.frames += resume == nullptr ? 1 : static_cast<std::int64_t>(kept.size());
  need.rows += step_;
  writer_ = std::make_unique<TrajectoryWriter>(options_.output, info, result_.particles,
                                               solver_.restart_size(), need.frames, need.rows);
  if (resume == nullptr) return;
  writer_->copy_from(resume->file(), kept, step_);
  frames_ = writer_->frames();
  if (kept.empty()) return;
  last_frame_step_ = *resume->file().step(kept.back());
  last_frame_time_ = resume->file().time(kept.back());
}

/// What this run will add to the file.
FrameSchedule::Need Run::room_needed(bool has_frame) {
  const TimeSettings& time = scene_.time;
  if (!time.adaptive) return schedule_.need(step_, time_, time.step, true, has_frame);
  double dt = time.max_step;
  try {
    dt = std::min(dt, solver_.choose_time_step().dt);
  } catch (const SimulationError&) {
    // The first step will meet it again, with a file to write the present state to.
  }
  if (!(dt > 0)) dt = time.max_step;
  FrameSchedule::Need need = schedule_.need(step_, time_, dt, false, has_frame);
  // Steps may become shorter, and to grow is to copy the file: twice the rows, or as many as take
  // a sixteenth of the room of the frames.
  const TrajectorySize frames{result_.particles, solver_.restart_size(), need.frames, 0};
  need.rows =
      std::max(2 * need.rows, static_cast<std::int64_t>(frames.bytes(solver_.traits().precision) /
                                                        16 / diagnostics_row_bytes));
  if (schedule_.steps())
    need.rows = std::min(need.rows, std::max<std::int64_t>(*schedule_.steps() - step_, 0));
  return need;
}

}  // namespace firn
