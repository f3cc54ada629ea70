// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/drivers/integration.hpp"

#include <string>

#include "firn/error.hpp"
#include "optimized/drivers/step.hpp"

namespace firn::optimized {

namespace {

[[noreturn]] void reject(const std::string& what) {
  SimulationError error(Stage::integration, SimulationError::Subject::solver, -1, what);
  error.state_intact = true;  // a sort inside blocks is no change
  throw error;
}

}  // namespace

template <class T>
void solve_implicit(Simulation<T>& sim) {
  const IntegratorSettings& settings = sim.scene->integrator;
  sim.solved = {};
  if (!(settings.implicitness > 0)) return;
  refresh_stress(sim);  // for the hardened stiffness of particles that were only just loaded
  const double dt_over_h = sim.dt / sim.scene->grid.spacing;
  const LinearSystem<T> system = assemble(
      sim.particles, sim.nodes, sim.constants, settings.implicitness * dt_over_h * dt_over_h,
      sim.implicit_kernels, sim.threads, sim.memory, sim.implicit);
  sim.solved = solve(system, settings.tolerance, settings.max_iterations);
  switch (sim.solved.status) {
    case SolveReport::Status::converged: return;
    case SolveReport::Status::not_finite: reject("residual is not finite");
    case SolveReport::Status::stagnates:
      reject("residual stagnates at " + to_text(sim.solved.residual));
    case SolveReport::Status::out_of_iterations:
      reject("not converged after " + std::to_string(sim.solved.iterations) +
             " iterations: relative residual " + to_text(sim.solved.residual) + ", asked for " +
             to_text(settings.tolerance));
  }
}

template <class T>
void solve_kept_fields(Simulation<T>& sim) {
  for (std::size_t n = 0; n < sim.nodes.size(); ++n) sim.implicit.motion[n] = sim.nodes.fields(n);
  sim.implicit.remember_v_star(sim.nodes);
  solve_implicit(sim);
  for (std::size_t n = 0; n < sim.nodes.size(); ++n)
    static_cast<NodeMotion<T>&>(sim.nodes.fields(n)) = sim.implicit.motion[n];
}

template void solve_implicit(Simulation<float>&);
template void solve_implicit(Simulation<double>&);
template void solve_kept_fields(Simulation<float>&);
template void solve_kept_fields(Simulation<double>&);

}  // namespace firn::optimized
