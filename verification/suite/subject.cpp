// SPDX-License-Identifier: BSD-3-Clause
#include "verification/suite/subject.hpp"

#include <algorithm>

#include "firn/error.hpp"
#include "verification/support/scenes.hpp"

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

namespace {

bool accepts_a_semi_implicit_step() {
  Scene scene = fixtures::elastic_scene("semi-implicit", 0x1p-4, 0x1p-14);
  scene.integrator.type = IntegratorType::semi_implicit;
  scene.integrator.implicitness = 1;
  scene.integrator.tolerance = 1e-3;
  scene.integrator.max_iterations = 100;
  try {
    run_steps(scene, fixtures::particles_at_rest(scene), 1, scene.time.step);
  } catch (const Unsupported&) {
    return false;
  } catch (const std::exception&) {
    // A solver that fails is not one that refuses: let the tests tell.
  }
  return true;
}

}  // namespace

bool solves_implicitly() {
  static const bool answer =
      traits().semi_implicit && (!the_subject.slow || accepts_a_semi_implicit_step());
  return answer;
}

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
  solver->steps(steps, dt);
  State result;
  solver->store(result);
  return result;
}

}  // namespace firn::suite
