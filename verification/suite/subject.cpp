// SPDX-License-Identifier: BSD-3-Clause
#include "verification/suite/subject.hpp"

#include <algorithm>

namespace firn::suite {

namespace {
Subject the_subject;
}

void set_subject(Subject subject) { the_subject = std::move(subject); }
const Subject& subject() { return the_subject; }

std::unique_ptr<Solver> make_subject() { return the_subject.create(the_subject.threads); }

studies::Subject study_subject() { return {make_subject, the_subject.precision}; }

namespace {

/// Asked once: a guest starts a program for it.
const SolverTraits& traits() {
  static const SolverTraits traits = make_subject()->traits();
  return traits;
}

}  // namespace

bool stops_at(Stage stage) {
  const std::vector<Stage>& stops = traits().stops;
  return std::find(stops.begin(), stops.end(), stage) != stops.end();
}

bool solves_implicitly() { return traits().semi_implicit; }

double rounded(double x) { return in_float() ? double{static_cast<float>(x)} : x; }

State run_through(const Scene& scene, const State& state, Stage last, double dt,
                  StepReport* report) {
  const auto solver = make_subject();
  solver->load(scene, state);
  const StepReport done = solver->advance_through(last, dt);
  if (report != nullptr) *report = done;
  State result;
  solver->store(result);
  return result;
}

State run_steps(const Scene& scene, const State& state, int steps, double dt) {
  const auto solver = make_subject();
  solver->load(scene, state);
  for (int n = 0; n < steps; ++n) solver->step(dt);
  State result;
  solver->store(result);
  return result;
}

}  // namespace firn::suite
