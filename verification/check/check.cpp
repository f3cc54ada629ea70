// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/check.hpp"

#include <algorithm>
#include <string>

#include "firn/error.hpp"
#include "firn/scene_hash.hpp"
#include "verification/check/run.hpp"

namespace firn {

namespace {

void require(const Scene& scene, const Solver& reference, const Solver& subject,
             const CheckOptions& options) {
  if (options.steps < 1)
    throw InputError("--steps", "number of steps to compare", std::to_string(options.steps),
                     "1 or more");
  if (options.start_step < 0)
    throw InputError("--start-step", "steps before the comparison",
                     std::to_string(options.start_step), "0 or more");
  if (reference.traits().stops.size() != stage_count)
    throw InputError("--against", "a reference must stop after every stage",
                     reference.traits().name + " with " +
                         std::to_string(reference.traits().stops.size()) + " stops",
                     std::to_string(stage_count) + " stops");
  for (const Solver* solver : {&reference, &subject}) {
    const SolverTraits& traits = solver->traits();
    if (scene.semi_implicit() ? !traits.semi_implicit : !traits.explicit_euler)
      throw Unsupported("scene " + scene.name, "integrator type not supported by " + traits.name,
                        scene.semi_implicit() ? "semi-implicit" : "explicit",
                        scene.semi_implicit() ? "explicit" : "semi-implicit");
    const std::vector<Stage>& stops = traits.stops;
    if (stops.empty() || stops.back() != Stage::positions ||
        !std::is_sorted(stops.begin(), stops.end()))
      throw InputError("solver " + traits.name, "stops that it declares",
                       std::to_string(stops.size()) + " of them",
                       "ascending order, positions last");
  }
}

/// The state after `steps` steps of the reference.
State advanced(const Scene& scene, const State& initial, Solver& reference, std::int64_t steps) {
  if (steps == 0) return initial;
  State state;
  reference.load(scene, initial);
  for (std::int64_t n = 0; n < steps; ++n) reference.step(reference.choose_time_step().dt);
  reference.store(state);
  state.grid.clear();
  return state;
}

}  // namespace

CheckReport run_check(const Scene& scene, Solver& reference, Solver& subject,
                      const CheckOptions& options) {
  return run_check(scene, initial_state(scene), reference, subject, options);
}

CheckReport run_check(const Scene& scene, const State& initial, Solver& reference, Solver& subject,
                      const CheckOptions& options) {
  require(scene, reference, subject, options);
  return run_check(scene,
                   {{advanced(scene, initial, reference, options.start_step), options.steps}},
                   reference, subject, options);
}

CheckReport run_check(const Scene& scene, const std::vector<CheckWindow>& windows,
                      Solver& reference, Solver& subject, const CheckOptions& options) {
  require(scene, reference, subject, options);
  CheckReport report;
  report.scene = scene.name;
  report.scene_hash = scene_hash(scene.toml);
  report.reference = reference.traits().name;
  report.subject = subject.traits().name;
  report.precision = subject.traits().precision;
  report.mode = options.mode;
  check::Recorder recorder(report, options.error_map);
  for (const CheckWindow& window : windows) {
    report.particles = std::max(report.particles, window.start.particles.size());
    report.windows.push_back({window.start.step, 0});
    CheckOptions one = options;
    one.steps = window.steps;
    const std::int64_t before = report.steps;
    if (options.progress)
      one.progress = [&](std::int64_t done) {
        report.interrupted = !options.progress(before + done);
        return !report.interrupted;
      };
    if (options.mode == CheckMode::lockstep)
      check::run_lockstep(scene, window.start, reference, subject, one, recorder);
    else
      check::run_free(scene, window.start, reference, subject, one, recorder);
    report.windows.back().steps = report.steps - before;
    if (report.interrupted || report.windows.back().steps < window.steps) break;
  }
  std::int64_t planned = 0;
  for (const CheckWindow& window : windows) planned += window.steps;
  report.interrupted = report.interrupted && report.steps < planned;
  recorder.finish();
  report.not_exercised = not_exercised(scene, report.exercised);
  return report;
}

}  // namespace firn
