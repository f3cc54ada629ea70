// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/simulate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "firn/error.hpp"
#include "io/output_error.hpp"
#include "simulation/run.hpp"

namespace firn {

int RunResult::exit_status() const {
  switch (status) {
    case RunStatus::completed: return 0;
    case RunStatus::interrupted: return 130;
    case RunStatus::failed: return 3;
  }
  return 3;
}

namespace {

constexpr int most_retries = 10;

/// Names the first particle with a number that is not finite, if there is one.
SimulationError not_finite(const Solver& solver, const std::string& quantity) {
  State state;
  solver.store(state);
  const Particles& p = state.particles;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (firn::not_finite(p, i) == nullptr) continue;
    return SimulationError(Stage::positions, SimulationError::Subject::particle,
                           static_cast<std::int64_t>(i),
                           "not finite after the step (diagnostics: " + quantity + ")");
  }
  return SimulationError(Stage::positions, SimulationError::Subject::solver, -1,
                         "diagnostics not finite after the step: " + quantity);
}

void require_finite(const Solver& solver, const DiagnosticsRow& row) {
  double values[3];
  for (std::size_t c = 0; c < diagnostics_columns.size(); ++c) {
    get_column(row, c, values);
    for (int i = 0; i < diagnostics_columns[c].components; ++i)
      if (!std::isfinite(values[i])) throw not_finite(solver, diagnostics_columns[c].name);
  }
}

}  // namespace

RunResult Run::operator()() {
  start();
  try {
    result_.diagnostics = {solver_.diagnostics(scene_)};
    result_.diagnostics.time = time_;
    run_to_the_end();
    if (step_ != last_frame_step_) write_frame();
  } catch (const OutputError& error) {
    // The frames that are in the file are what is left.
    result_.status = RunStatus::failed;
    result_.message = error.what();
    step_ = last_frame_step_;
    time_ = last_frame_time_;
  } catch (const std::exception& error) {
    fail(error.what());
  }
  try {
    if (writer_) writer_->finish();
  } catch (const OutputError& error) {
    result_.status = RunStatus::failed;
    result_.message += (result_.message.empty() ? "" : "; ") + std::string(error.what());
  }
  result_.step = step_;
  result_.time = time_;
  result_.frames = frames_;
  result_.seconds = seconds();
  return result_;
}

void Run::run_to_the_end() {
  while (!schedule_.finished(step_, time_)) {
    if (options_.stop != nullptr && options_.stop->load()) {
      result_.status = RunStatus::interrupted;
      result_.message =
          "interrupted after step " + std::to_string(step_) + ", t = " + to_text(time_) + " s";
      return;
    }
    const double previous_time = time_;
    advance();
    if (schedule_.frame_due(step_, previous_time, time_)) write_frame();
    report_step();
  }
}

/// One step by the scene's Δt. Semi-implicit and adaptive: half of it when the
/// step fails, and so on.
void Run::advance() {
  TimeStep chosen;
  for (int attempt = 0; true; ++attempt) {
    try {
      if (attempt == 0) chosen = solver_.choose_time_step();
      step(chosen.dt);
      ++result_.steps_by_bound[static_cast<std::size_t>(chosen.bound)];
      return;
    } catch (const SimulationError& error) {
      if (!error.state_intact) return_to_last_good_state();
      if (!may_retry() || attempt == most_retries || chosen.dt == 0 || !lost_.empty()) throw;
      ++result_.retries;
      if (options_.on_retry)
        options_.on_retry({step_, time_, attempt + 1, chosen.dt, chosen.dt / 2, error.what()});
      chosen.dt /= 2;
    } catch (const std::exception&) {
      return_to_last_good_state();
      throw;
    }
  }
}

void Run::step(double dt) {
  if (!(dt > 0) || !(time_ + dt > time_) || !std::isfinite(dt)) {
    SimulationError error(
        Stage::rasterize, SimulationError::Subject::solver, -1,
        "a time step of " + to_text(dt) + " s does not advance t = " + to_text(time_) + " s");
    error.state_intact = true;
    throw error;
  }
  const StepReport report = solver_.step(dt);
  DiagnosticsRow row{solver_.diagnostics(scene_)};
  row.time = time_ + dt;
  row.dt = dt;
  row.grid_nodes = report.grid_nodes;
  row.solver_iterations = report.solver_iterations;
  row.solver_residual = report.solver_residual;
  require_finite(solver_, row);

  ++step_;
  time_ += dt;
  last_good_.dts.push_back(dt);
  if (writer_) writer_->add_row(row);
  ++result_.steps_run;
  result_.diagnostics = row;
  result_.worst_residual = std::max(result_.worst_residual, report.solver_residual);
  if (report.solver_indefinite) ++result_.indefinite_steps;
}

/// A solver that fails here, too, is lost: what it was last seen with in memory
/// is the last good state then.
void Run::return_to_last_good_state() {
  try {
    last_good_.repeat_on(solver_, scene_);
    // A retry may fail again: the way back is short then.
    if (may_retry()) last_good_.take(solver_, step_, time_);
  } catch (const std::exception& error) {
    lost_ = error.what();
  }
}

void Run::write_frame() {
  last_good_.take(solver_, step_, time_);
  write_last_good_state();
}

void Run::write_last_good_state() {
  const State& state = last_good_.state;
  try {
    if (writer_) writer_->write_frame(state, last_good_.restart);
  } catch (const SimulationError& error) {
    throw OutputError(error.what());  // nothing better than the frames before is left
  }
  last_frame_step_ = state.step;
  last_frame_time_ = state.time;
  if (options_.on_frame) options_.on_frame({frames_, state.step, state.time});
  ++frames_;
}

/// The run ends here, with the last good state in the file.
void Run::fail(const std::string& message) {
  result_.status = RunStatus::failed;
  result_.message = message;
  try {
    if (lost_.empty()) {
      if (step_ != last_frame_step_) write_frame();
      return;
    }
    result_.message += "; the steps since step " + std::to_string(last_good_.state.step) +
                       " are lost, because repeating them failed: " + lost_;
    step_ = last_good_.state.step;
    time_ = last_good_.state.time;
    if (writer_) writer_->forget_rows_after(step_);
    if (step_ != last_frame_step_) write_last_good_state();
  } catch (const std::exception& error) {
    result_.message +=
        "; and the last good state could not be written: " + std::string(error.what());
    step_ = last_frame_step_;
    time_ = last_frame_time_;
  }
}

void Run::report_step() const {
  if (!options_.on_step) return;
  Progress progress;
  progress.step = step_;
  progress.time = time_;
  progress.end = schedule_.end();
  const double all_time = schedule_.end() - first_time_;
  if (all_time > 0) progress.fraction = (time_ - first_time_) / all_time;
  if (schedule_.steps())
    progress.fraction =
        std::max(progress.fraction, static_cast<double>(step_ - first_step_) /
                                        static_cast<double>(*schedule_.steps() - first_step_));
  progress.fraction = std::min(progress.fraction, 1.0);
  progress.frames = frames_;
  progress.particles = result_.particles;
  progress.seconds = seconds();
  if (progress.seconds > 0)
    progress.steps_per_second = static_cast<double>(result_.steps_run) / progress.seconds;
  progress.diagnostics = &result_.diagnostics;
  options_.on_step(progress);
}

RunResult simulate(const Scene& scene, Solver& solver, const RunOptions& options) {
  return Run(scene, solver, options)();
}

}  // namespace firn
