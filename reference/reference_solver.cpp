// SPDX-License-Identifier: BSD-3-Clause
#include "reference/reference_solver.hpp"

#include <algorithm>
#include <stdexcept>

#include "reference/diagnostics.hpp"
#include "reference/failure.hpp"
#include "reference/grid_nodes.hpp"
#include "reference/time_step.hpp"

namespace firn::reference {

const SolverTraits& ReferenceSolver::traits() const {
  static const SolverTraits traits = [] {
    SolverTraits t;
    t.name = reference_name;
    t.precision = Precision::float64;
    t.stops.assign(all_stages.begin(), all_stages.end());
    t.semi_implicit = true;
    t.pace = Pace::plain;
    return t;
  }();
  return traits;
}

void ReferenceSolver::load(const Scene& scene, const State& state) {
  require_consistent(scene, state.particles);
  scene_ = &scene;
  state_ = state;
  if (state_.next == Stage::rasterize) state_.grid.clear();
  last_good_ = state_;
  in_step_ = false;
  solve_ = {};
}

TimeStep ReferenceSolver::choose_time_step() {
  try {
    return reference::choose_time_step(*scene_, state_.particles);
  } catch (SimulationError& error) {
    error.state_intact = true;
    throw;
  }
}

/// For a new step and for one that was loaded in its middle.
void ReferenceSolver::find_nodes() {
  std::vector<NodeIndex> node;
  stencils_.build(*scene_, state_.particles, state_.next, node);
  state_.grid = spread_over(node, state_.grid);
}

StepReport ReferenceSolver::advance_through(Stage last, double dt) {
  if (number(last) < number(state_.next))
    throw std::logic_error("advance_through: that stage of the step is over");
  if (!(dt > 0 && finite(dt)))
    throw InputError("advance_through", "time step", to_text(dt), "> 0 and finite");
  try {
    if (state_.next == Stage::rasterize) {
      state_.grid.clear();
      last_good_ = state_;
      state_.dt = dt;
      solve_ = {};
    }
    if (!in_step_) find_nodes();
    in_step_ = true;
    for (Stage stage = state_.next;; stage = next(stage)) {
      run_stage(stage, *scene_, stencils_, dt, state_, solve_);
      state_.next = next(stage);
      if (stage == last) break;
    }
  } catch (SimulationError& error) {
    state_ = last_good_;
    in_step_ = false;
    error.state_intact = true;
    throw;
  }
  StepReport report;
  report.dt = dt;
  report.grid_nodes = nodes_of_positive_mass(state_.grid);
  report.solver_iterations = solve_.iterations;
  report.solver_residual = solve_.residual;
  report.solver_indefinite = solve_.indefinite;
  if (last == Stage::positions) {
    state_.time += dt;
    state_.step += 1;
    state_.dt = 0;
    last_good_.grid.clear();
    in_step_ = false;
  }
  return report;
}

void ReferenceSolver::store(State& state) const {
  state = state_;
  drop_massless_nodes(state.grid);
}

Diagnostics ReferenceSolver::diagnostics(const Scene& scene) const {
  return reference::measure(scene, state_);
}

double ReferenceSolver::bytes_per_particle() const {
  const double n = static_cast<double>(state_.particles.size());
  if (n == 0) return 0;
  // x, v, m, V_0, F_E, F_P, id, material; twice, because the last good state is kept
  constexpr double particle = (3 + 3 + 1 + 1 + 9 + 9 + 1) * 8 + 4;
  return 2 * particle + (stencils_.bytes() + bytes(state_.grid)) / n;
}

}  // namespace firn::reference

namespace firn {

std::unique_ptr<Solver> make_reference_solver(const SolverOptions& options) {
  if (options.precision != Precision::float64)
    throw InputError("--precision", "not supported by solver reference",
                     std::string(name(options.precision)), "double");
  return std::make_unique<reference::ReferenceSolver>();
}

SolverEntry reference_entry() {
  return {reference_name,
          "the paper's steps one by one: plain, sequential, double precision",
          {Precision::float64},
          make_reference_solver};
}

}  // namespace firn
