#include "reference/reference_solver.hpp"

#include <algorithm>
#include <stdexcept>

#include "reference/diagnostics.hpp"
#include "reference/failure.hpp"
#include "reference/grid_nodes.hpp"
#include "reference/steps.hpp"
#include "reference/time_step.hpp"

namespace firn::reference {

const SolverTraits& ReferenceSolver::traits() const {
  static const SolverTraits traits = [] {
    SolverTraits t;
    t.name = "reference";
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
  report_ = {};
}

TimeStep ReferenceSolver::choose_time_step() {
  try {
    return reference::choose_time_step(*scene_, state_.particles);
  } catch (SimulationError& error) {
    error.state_intact = true;
    throw;
  }
}

void ReferenceSolver::run(Stage stage, double dt) {
  const Scene& scene = *scene_;
  Particles& particles = state_.particles;
  Grid& grid = state_.grid;
  switch (stage) {
    case Stage::rasterize:
      stencils_.build(scene, particles, stage, grid.node);
      rasterize(particles, stencils_, grid);
      break;
    case Stage::volumes: volumes(scene, stencils_, grid, particles); break;
    case Stage::grid_forces: grid_forces(scene, particles, stencils_, grid); break;
    case Stage::grid_velocities: grid_velocities(scene, dt, grid); break;
    case Stage::grid_collisions: grid_collisions(scene, state_.time, grid); break;
    case Stage::integration: {
      const IntegrationReport solve = integration(scene, particles, stencils_, dt, grid);
      report_.solver_iterations = solve.iterations;
      report_.solver_residual = solve.residual;
      report_.solver_indefinite = solve.indefinite;
      break;
    }
    case Stage::deformation: deformation(scene, stencils_, grid, dt, particles); break;
    case Stage::particle_velocities: particle_velocities(scene, stencils_, grid, particles); break;
    case Stage::particle_collisions: particle_collisions(scene, state_.time, particles); break;
    case Stage::positions: positions(scene, dt, particles); break;
  }
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
      report_ = {};
    } else if (!in_step_) {
      resume_step();
    }
    in_step_ = true;
    for (Stage stage = state_.next;; stage = next(stage)) {
      run(stage, dt);
      state_.next = next(stage);
      if (stage == last) break;
    }
  } catch (SimulationError& error) {
    state_ = last_good_;
    in_step_ = false;
    error.state_intact = true;
    throw;
  }
  report_.dt = dt;
  report_.grid_nodes = nodes_of_positive_mass(state_.grid);
  if (last == Stage::positions) {
    state_.time += dt;
    state_.step += 1;
    state_.dt = 0;
    last_good_.grid.clear();
    in_step_ = false;
  }
  return report_;
}

void ReferenceSolver::resume_step() {
  std::vector<NodeIndex> node;
  stencils_.build(*scene_, state_.particles, state_.next, node);
  state_.grid = spread_over(node, state_.grid);
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
  return {"reference",
          "the paper's steps one by one: plain, sequential, double precision",
          {Precision::float64},
          make_reference_solver};
}

}  // namespace firn
