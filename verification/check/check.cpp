// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/check.hpp"

#include <algorithm>
#include <string>

#include "firn/error.hpp"
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
      throw InputError("scene " + scene.name, "integrator type not supported by " + traits.name,
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
  CheckReport report;
  report.scene = scene.name;
  report.reference = reference.traits().name;
  report.subject = subject.traits().name;
  report.precision = subject.traits().precision;
  report.mode = options.mode;
  report.start_step = options.start_step;
  report.particles = initial.particles.size();
  const State start = advanced(scene, initial, reference, options.start_step);
  check::Recorder recorder(report);
  if (options.mode == CheckMode::lockstep)
    check::run_lockstep(scene, start, reference, subject, options, recorder);
  else
    check::run_free(scene, start, reference, subject, options, recorder);
  recorder.finish();
  return report;
}

}  // namespace firn
