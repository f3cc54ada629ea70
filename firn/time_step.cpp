// SPDX-License-Identifier: BSD-3-Clause
#include "firn/time_step.hpp"

namespace firn {

std::string_view name(TimeStepBound bound) {
  switch (bound) {
    case TimeStepBound::fixed: return "fixed";
    case TimeStepBound::max_step: return "max_step";
    case TimeStepBound::cfl: return "cfl";
    case TimeStepBound::elastic_cfl: return "elastic_cfl";
  }
  return "unknown";
}

TimeStep time_step_by_rule(const Scene& scene, double fastest_particle, double fastest_sound) {
  const TimeSettings& time = scene.time;
  if (!time.adaptive) return {time.step, TimeStepBound::fixed};
  TimeStep chosen{time.max_step, TimeStepBound::max_step};
  const auto limit = [&](double dt, TimeStepBound bound) {
    if (dt < chosen.dt) chosen = {dt, bound};
  };
  const double h = scene.grid.spacing;
  limit(time.cfl * h / fastest_particle, TimeStepBound::cfl);
  if (!scene.semi_implicit())
    limit(time.elastic_cfl * h / fastest_sound, TimeStepBound::elastic_cfl);
  return chosen;
}

}  // namespace firn
