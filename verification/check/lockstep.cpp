// SPDX-License-Identifier: BSD-3-Clause
/// Lockstep: the subject is loaded with the reference's own state before every
/// stretch of stages between two of its stops.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <fmt/format.h>

#include "verification/check/chosen_path.hpp"
#include "verification/check/comparison.hpp"
#include "verification/check/fields.hpp"
#include "verification/check/implicit_residual.hpp"
#include "verification/check/run.hpp"

namespace firn::check {

namespace {

/// What a stretch writes, each field under the last stage that writes it.
struct Written {
  Field field;
  Stage by;
};

std::vector<Written> written_between(Stage from, Stage through, const State& after) {
  std::vector<Written> fields;
  for (const Stage stage : all_stages) {
    if (stage < from || stage > through) continue;
    for (const Field field : fields_written(stage)) {
      std::erase_if(fields, [&](const Written& w) { return w.field == field; });
      fields.push_back({field, stage});
    }
  }
  // The grid is gone once the step is complete, and a stage need not write every
  // field (free directions exist in semi-implicit scenes only).
  std::erase_if(fields, [&](const Written& w) {
    return is_node_field(w.field) && (through == Stage::positions || length(after, w.field) == 0);
  });
  return fields;
}

/// Where two states of the same solver differ in a bit; nothing if nowhere.
std::optional<std::string> first_difference(const State& step, const State& stages) {
  for (const Field field : particle_fields)
    for (std::size_t p = 0; p < length(step, field); ++p)
      for (int c = 0; c < components(field); ++c) {
        const double a = value(step, field, p, c), b = value(stages, field, p, c);
        if (std::memcmp(&a, &b, sizeof a) != 0)
          return fmt::format(
              "{} of particle {} (id {}), component {}: step() {:.17g}, stages {:.17g}",
              name(field), p, step.particles.id[p], c, a, b);
      }
  return {};
}

class Lockstep {
 public:
  Lockstep(const Scene& scene, Solver& reference, Solver& subject, Recorder& recorder)
      : scene_(scene),
        reference_(reference),
        subject_(subject),
        recorder_(recorder),
        model_(scene, subject.traits().precision),
        whole_step_(scene, subject.traits().precision),
        whole_steps_only_(subject.traits().stops.size() == 1) {}

  /// One step from `start`; leaves the reference's result there. False: the subject
  /// failed in a way after which there is nothing to compare.
  bool step(State& start);

 private:
  bool compare_stretch(Stage from, Stage stop, const State& input, const State& after, double dt,
                       const BoundModel& model, bool by_step, const std::optional<Fork>& fork);
  void compare_kept(const State& input, const State& after, const State& theirs, Stage from,
                    Stage stop, const std::vector<Written>& written, const BoundModel& model);
  void check_time_step(const State& start, double dt, const TimeStep& theirs);
  void check_solve(const State& after, const BoundModel& model, double dt, Stage from);
  bool check_fused(const State& start, double dt);
  std::optional<Stage> stop_with_grid() const;
  void run_to_grid(const State& input, double dt);

  const Scene& scene_;
  Solver& reference_;
  Solver& subject_;
  Recorder& recorder_;
  BoundModel model_, whole_step_;
  bool whole_steps_only_;
  State theirs_, staged_;
};

bool Lockstep::step(State& start) {
  reference_.load(scene_, start);
  const TimeStep chosen = reference_.choose_time_step();
  const double dt = chosen.dt;
  recorder_.set_step(start.step);
  recorder_.exercised().add_step(chosen.bound);

  model_.load(start);
  whole_step_.load(start);
  State input = start, before = start, after;
  // Where the reference's path first has a choice, in the present stretch and in the step.
  std::optional<Fork> stretch_fork, step_fork;
  Stage from = Stage::rasterize;
  for (const Stage stage : all_stages) {
    const StepReport told = reference_.advance_through(stage, dt);
    const bool indefinite = told.solver_indefinite;
    reference_.store(after);
    recorder_.exercised().add(scene_, stage, before, after, told);
    model_.advance(stage, before, after, dt, indefinite);
    whole_step_.advance(stage, before, after, dt, indefinite);
    if (stage == Stage::grid_collisions || stage == Stage::particle_collisions) {
      const auto fork_where_in_doubt = [&](const BoundModel& model, std::optional<Fork>& fork) {
        if (!fork && !model.doubtful().empty()) fork.emplace(Fork{after, model, stage});
      };
      if (!whole_steps_only_) fork_where_in_doubt(model_, stretch_fork);
      fork_where_in_doubt(whole_step_, step_fork);
    }
    const auto& stops = subject_.traits().stops;
    if (std::find(stops.begin(), stops.end(), stage) != stops.end()) {
      if (!whole_steps_only_ &&
          !compare_stretch(from, stage, input, after, dt, model_, false, stretch_fork))
        return false;
      // Another path may have been followed in between.
      if (stretch_fork && stage != Stage::positions) reference_.load(scene_, after);
      stretch_fork.reset();
      input = after;
      from = next(stage);
      model_.load(after);
    }
    std::swap(before, after);
  }
  // `before` now holds the completed step.
  if (!compare_stretch(Stage::rasterize, Stage::positions, start, before, dt, whole_step_, true,
                       step_fork))
    return false;
  if (!whole_steps_only_ && !check_fused(start, dt)) return false;
  start = std::move(before);
  start.grid.clear();
  return true;
}

bool Lockstep::compare_stretch(Stage from, Stage stop, const State& input, const State& own_after,
                               double dt, const BoundModel& own_model, bool by_step,
                               const std::optional<Fork>& fork) {
  recorder_.set_input(input, dt);
  TimeStep their_step;
  const bool done = recorder_.guard(from, stop, [&] {
    subject_.load(scene_, input);
    if (by_step) their_step = subject_.choose_time_step();
    if (by_step)
      subject_.step(dt);
    else
      subject_.advance_through(stop, dt);
    subject_.store(theirs_);
  });
  if (!done) return false;
  if (const auto fault = shape_fault(own_after, theirs_, own_model.roundoff().eps)) {
    recorder_.diverged(from, stop, {}, *fault);
    return false;
  }
  // Where contact is in doubt the subject is compared with the reference on the subject's path.
  std::optional<Path> path;
  if (fork) {
    const State* with_grid = stop == Stage::positions ? nullptr : &theirs_;
    if (!with_grid && fork->stage == Stage::grid_collisions && stop_with_grid()) {
      if (!recorder_.guard(from, stop, [&] { run_to_grid(input, dt); })) return false;
      with_grid = &staged_;
    }
    path.emplace(chosen_path({scene_, reference_, input, theirs_, dt}, *fork, stop, with_grid));
  }
  const State& after = path ? path->after : own_after;
  const BoundModel& model = path ? path->model : own_model;
  const std::vector<Written> written = written_between(from, stop, after);
  for (const Written& w : written) {
    if (is_node_field(w.field) && length(theirs_, w.field) != theirs_.grid.size()) {
      recorder_.diverged(from, stop, w.field,
                         fmt::format("{} holds {} entries for {} nodes", name(w.field),
                                     length(theirs_, w.field), theirs_.grid.size()));
      return false;
    }
    recorder_.compare({scene_, after, theirs_, model.bounds(), model.stencils(), input.step}, from,
                      stop, w.by, w.field, false);
  }
  compare_kept(input, after, theirs_, from, stop, written, model);
  if (by_step) check_time_step(input, dt, their_step);
  if (stop == Stage::integration && scene_.semi_implicit()) check_solve(after, model, dt, from);
  return true;
}

/// The first stop at which the subject has a grid after contact.
std::optional<Stage> Lockstep::stop_with_grid() const {
  for (const Stage stop : subject_.traits().stops)
    if (stop >= Stage::grid_collisions && stop != Stage::positions) return stop;
  return {};
}

/// The subject from `input` to stop_with_grid(), without a reload in between.
void Lockstep::run_to_grid(const State& input, double dt) {
  subject_.load(scene_, input);
  for (const Stage stop : subject_.traits().stops) {
    if (stop < input.next) continue;
    subject_.advance_through(stop, dt);
    if (stop == stop_with_grid()) break;
  }
  subject_.store(staged_);
}

/// Fields that no stage of the stretch writes must come back as they were loaded, to
/// the rounding of load and store. Of the grid's fields this matters for v_iⁿ, which stage 8
/// needs again; a solver that recomputes it there may leave it empty.
void Lockstep::compare_kept(const State& input, const State& after, const State& theirs, Stage from,
                            Stage stop, const std::vector<Written>& written,
                            const BoundModel& model) {
  const auto kept = [&](Field field) {
    return std::none_of(written.begin(), written.end(),
                        [&](const Written& w) { return w.field == field; });
  };
  for (const Field field : particle_fields)
    if (kept(field))
      recorder_.compare({scene_, after, theirs, model.bounds(), model.stencils(), input.step}, from,
                        stop, stop, field, true);
  const Field old_velocity = Field::node_velocity;
  const bool in_grid = stop != Stage::positions && length(after, old_velocity) > 0;
  if (in_grid && kept(old_velocity) && length(theirs, old_velocity) == theirs.grid.size())
    recorder_.compare({scene_, after, theirs, model.bounds(), model.stencils(), input.step}, from,
                      stop, stop, old_velocity, true);
}

/// Δt by the scene's own rule, where it depends on the state. Both of its limits are
/// continuous: cfl·h/max‖v_p‖ costs a few roundings; the elastic one takes a square
/// root of the hardened moduli, whose relative error is ξ·δJ_P with δJ_P some 10 eps
/// (rounding of F_P and six products of the determinant).
void Lockstep::check_time_step(const State& start, double dt, const TimeStep& theirs) {
  if (!scene_.time.adaptive) return;
  double hardening = 0;
  for (const Material& material : scene_.materials)
    hardening = std::max(hardening, material.hardening);
  double largest_F_P = 1;
  for (const Mat3& F_P : start.particles.F_P) largest_F_P = std::max(largest_F_P, F_P.norm());
  const double bound =
      model_.roundoff().eps * (Roundoff::stress + 10 * hardening * std::pow(largest_F_P, 3));
  const bool valid = std::abs(theirs.dt - dt) <= bound * dt;
  recorder_.property("choose_time_step() agrees", 1, valid,
                     valid ? "" : fmt::format("{:.9g} s against {:.9g} s", theirs.dt, dt));
}

/// The solve's own promise. The system is the reference's; v_i* of a subject that has come
/// here from an earlier stage differs from it by no more than its bound.
void Lockstep::check_solve(const State& after, const BoundModel& model, double dt, Stage from) {
  std::vector<Vec3> v_new = after.grid.v_star;  // at nodes that the subject does not have
  std::size_t j = 0;
  for (std::size_t i = 0; i < after.grid.size(); ++i) {
    while (j < theirs_.grid.size() && theirs_.grid.node[j] < after.grid.node[i]) ++j;
    if (j < theirs_.grid.size() && theirs_.grid.node[j] == after.grid.node[i])
      v_new[i] = theirs_.grid.v_new[j];
  }
  const ImplicitResidual r = implicit_residual(scene_, after, model, v_new, dt);
  const auto nodes = static_cast<std::int64_t>(after.grid.size());
  const bool solved = r.residual <= r.allowed;
  recorder_.property("v_i_new solves the semi-implicit system", nodes, solved,
                     solved ? ""
                            : fmt::format("residual {:.3g} in the mass norm, allowed {:.3g}",
                                          r.residual, r.allowed),
                     from, Stage::integration);
  const bool held = r.held_in_bounds <= 1;
  const NodeIndex& n = after.grid.node[r.held_node];
  recorder_.property(
      "the solve moves no node against its contact", nodes, held,
      held ? ""
           : fmt::format("node ({},{},{}) by {:.3g} of its bound", n.i, n.j, n.k, r.held_in_bounds),
      from, Stage::integration);
}

/// step() is promised to be bit for bit what the stages reach without a reload in
/// between: compared with itself, so no tolerance.
bool Lockstep::check_fused(const State& start, double dt) {
  // theirs_ still holds the result of step() from `start`.
  const bool done = recorder_.guard(Stage::rasterize, Stage::positions, [&] {
    subject_.load(scene_, start);
    for (const Stage stop : subject_.traits().stops) subject_.advance_through(stop, dt);
    subject_.store(staged_);
  });
  if (!done) return false;
  if (const auto fault = shape_fault(theirs_, staged_, 0)) {
    recorder_.diverged(Stage::rasterize, Stage::positions, {}, "stages without reload: " + *fault);
    return false;
  }
  std::int64_t compared = 0;
  for (const Field field : particle_fields)
    compared += static_cast<std::int64_t>(length(theirs_, field)) * components(field);
  const auto difference = first_difference(theirs_, staged_);
  recorder_.property("step() equals its stages bit for bit", compared, !difference,
                     difference.value_or(""));
  return true;
}

}  // namespace

void run_lockstep(const Scene& scene, State state, Solver& reference, Solver& subject,
                  const CheckOptions& options, Recorder& recorder) {
  Lockstep lockstep(scene, reference, subject, recorder);
  for (std::int64_t n = 0; n < options.steps; ++n) {
    if (!lockstep.step(state)) return;
    recorder.step_done();
    if (options.progress && !options.progress(n + 1)) return;
  }
}

}  // namespace firn::check
