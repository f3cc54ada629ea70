// SPDX-License-Identifier: BSD-3-Clause
#include "verification/studies/stress_list.hpp"

#include <algorithm>

namespace firn::studies {

bool finite(const Particles& p) {
  for (std::size_t at = 0; at < p.size(); ++at)
    if (!p.x[at].allFinite() || !p.v[at].allFinite() || !p.F_E[at].allFinite() ||
        !p.F_P[at].allFinite())
      return false;
  return true;
}

Vec3 momentum(const Particles& p) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t at = 0; at < p.size(); ++at) sum += p.m[at] * p.v[at];
  return sum;
}

StressOutcome run(const Subject& subject, const Situation& situation) {
  using Ending = StressOutcome::Ending;
  StressOutcome outcome;
  const auto solver = subject.create();
  try {
    solver->load(situation.scene, situation.state);
    for (; outcome.steps < situation.steps; ++outcome.steps) {
      subject.step(*solver, situation.dt);
      solver->store(outcome.state);
      for (const Vec3& v : outcome.state.particles.v)
        outcome.fastest = std::max(outcome.fastest, v.norm());
      if (finite(outcome.state.particles)) continue;
      outcome.ending = Ending::silent;
      return outcome;
    }
  } catch (const SimulationError& error) {
    outcome.ending = Ending::failed;
    outcome.message = error.what();
    outcome.stage = error.stage();
    if (error.subject() == SimulationError::Subject::particle) outcome.particle = error.index();
    outcome.intact = error.state_intact;
    if (error.state_intact) solver->store(outcome.state);
  } catch (const InputError& error) {
    outcome.ending = Ending::refused;
    outcome.message = error.what();
    outcome.unsupported = dynamic_cast<const Unsupported*>(&error) != nullptr;
  }
  return outcome;
}

std::string StressOutcome::text() const {
  if (ending == Ending::silent)
    return "went on with numbers that are not finite from step " + std::to_string(steps);
  if (stopped()) return "stopped: " + message;
  return std::to_string(steps) + " steps, all finite";
}

}  // namespace firn::studies
