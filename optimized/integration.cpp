/// Step 6 as the solver runs it: the semi-implicit solve and what stages 7 and 8 gather.

#include <omp.h>
#include <string>

#include "firn/error.hpp"
#include "optimized/solver.hpp"

namespace firn::optimized {

namespace {

[[noreturn]] void reject(const std::string& what) {
  SimulationError error(Stage::integration, SimulationError::Subject::solver, -1, what);
  error.state_intact = true;  // nothing but node fields has been written
  throw error;
}

}  // namespace

/// v_i^{n+1} from (M + βΔt²H) v = M v* along the directions that contact leaves free.
template <class T>
void OptimizedSolver<T>::solve_implicit() {
  const IntegratorSettings& settings = scene_->integrator;
  solved_ = {};
  implicit_.remember_v_star(nodes_);
  if (!(settings.implicitness > 0)) return;
  refresh_stress();  // for the hardened stiffness of particles that were only just loaded
  const double dt_over_h = dt_ / scene_->grid.spacing;
  implicit_.assemble(particles_, nodes_, constants_, settings.implicitness * dt_over_h * dt_over_h);
  tiles_stale_ = gathered_stale_ = true;  // the solve uses their memory
  solved_ = implicit_.solve(settings.tolerance, settings.max_iterations);
  switch (solved_.status) {
    case SolveReport::Status::converged: return;
    case SolveReport::Status::not_finite: reject("residual is not finite");
    case SolveReport::Status::stagnates:
      reject("residual stagnates at " + to_text(solved_.residual));
    case SolveReport::Status::out_of_iterations:
      reject("not converged after " + std::to_string(solved_.iterations) +
             " iterations: relative residual " + to_text(solved_.residual) + ", asked for " +
             to_text(settings.tolerance));
  }
}

/// (v_new, u) of all nodes in the order in which blocks gather them.
template <class T>
void OptimizedSolver<T>::pack_all() {
  const int n = static_cast<int>(nodes_.size());
#pragma omp parallel for num_threads(threads_)
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    kernels_.pack_gathered(constants_, nodes_.fields(k), nodes_.gathered(k));
  }
}

template <class T>
void OptimizedSolver<T>::report_solve(StepReport& report) const {
  report.solver_iterations = solved_.iterations;
  report.solver_residual = solved_.residual;
  report.solver_indefinite = solved_.indefinite;
}

template void OptimizedSolver<float>::solve_implicit();
template void OptimizedSolver<double>::solve_implicit();
template void OptimizedSolver<float>::pack_all();
template void OptimizedSolver<double>::pack_all();
template void OptimizedSolver<float>::report_solve(StepReport&) const;
template void OptimizedSolver<double>::report_solve(StepReport&) const;

}  // namespace firn::optimized
