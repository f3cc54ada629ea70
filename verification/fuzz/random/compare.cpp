// SPDX-License-Identifier: BSD-3-Clause
#include "verification/fuzz/random/compare.hpp"

#include <algorithm>

#include "firn/error.hpp"
#include "verification/check/check.hpp"

namespace firn {

namespace {

/// Does a particle of the reference move more than 4 h in that step?
bool moves_far(const RandomCase& c, Solver& reference, std::int64_t step) {
  State state = initial_state(c.scene);
  reference.load(c.scene, state);
  double dt = 0;
  for (std::int64_t n = 0; n <= step; ++n) reference.step(dt = reference.choose_time_step().dt);
  reference.store(state);
  double farthest = 0;
  for (const Vec3& v : state.particles.v)
    farthest = std::max(farthest, dt * v.cwiseAbs().maxCoeff());
  return farthest > 4 * c.scene.grid.spacing;
}

}  // namespace

Comparison compare(const RandomCase& c, const MakeSolver& reference, const MakeSolver& subject) {
  CheckOptions options;
  options.steps = c.steps;
  options.start_step = c.start_step;
  const auto ours = reference(), theirs = subject();
  try {
    const CheckReport report = run_check(c.scene, *ours, *theirs, options);
    Comparison result;
    result.compared = report.compared();
    result.largest_in_bounds = report.largest_in_bounds();
    if (report.valid()) return result;
    const Divergence& d = *report.first_divergence;
    const auto says = [&](const char* text) { return d.message.find(text) != std::string::npos; };
    const bool beyond_float =
        report.precision == Precision::float32 && says("hardening exp(xi (1 - J_P)) is not finite");
    const bool beyond_cells =
        says("particle moves more than 4 cells in a step") && moves_far(c, *reference(), d.step);
    result.agreement = beyond_float || beyond_cells ? Agreement::out_of_range : Agreement::invalid;
    result.message = "step " + std::to_string(d.step) + ", stage " +
                     stage_range(d.from, d.through) +
                     (d.field ? ", " + std::string(name(*d.field)) : "") + ": " + d.message;
    return result;
  } catch (const SimulationError& error) {
    return {Agreement::reference_failed, error.what(), 0, 0};
  }
}

}  // namespace firn
