// SPDX-License-Identifier: BSD-3-Clause
#include "verification/studies/convergence.hpp"

#include <chrono>
#include <cmath>

#include "firn/error.hpp"

namespace firn::studies {

ExactProblem vortex_of_15_percent(int cells, double cfl, const AlphaPolicy& policy) {
  return exact::vortex(cells, cfl, policy, 0.15);
}

std::string Integration::text() const {
  return semi_implicit ? "implicit " + to_text(beta) : "explicit";
}

void Integration::set(Scene& scene) const {
  if (!semi_implicit) return;
  scene.integrator.type = IntegratorType::semi_implicit;
  scene.integrator.implicitness = beta;
  // Algebraic errors far below the discretization errors of 1e-3 that are reached here.
  scene.integrator.tolerance = 1e-6;
  scene.integrator.max_iterations = 2000;
}

ConvergenceRun run_exact(const Subject& subject, Solver& solver, const ExactProblem& problem) {
  using Clock = std::chrono::steady_clock;
  const double dt = problem.scene.time.step;
  State state = problem.initial;
  ConvergenceRun run;
  solver.load(problem.scene, problem.initial);
  for (int n = 0; n < problem.steps; ++n) {
    if (subject.before_step) subject.before_step();
    // The time to hand over the body force is the harness's, not the solver's.
    if (problem.body_force) {
      solver.store(state);
      problem.push(state);
      solver.load(problem.scene, state);
    }
    const auto start = Clock::now();
    solver.step(dt);
    run.seconds += std::chrono::duration<double>(Clock::now() - start).count();
  }
  solver.store(state);
  run.error = problem.relative_error(state);
  return run;
}

double order(double coarse_error, double fine_error) {
  return std::log2(coarse_error / fine_error);
}

}  // namespace firn::studies
