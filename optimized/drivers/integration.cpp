/// Step 6 as the solver runs it: the semi-implicit solve and what stages 7 and 8 gather.

#include <omp.h>
#include <string>

#include "firn/error.hpp"
#include "optimized/drivers/solver.hpp"

namespace firn::optimized {

namespace {

[[noreturn]] void reject(const std::string& what) {
  SimulationError error(Stage::integration, SimulationError::Subject::solver, -1, what);
  error.state_intact = true;  // a sort inside blocks is no change
  throw error;
}

}  // namespace

/// v_i^{n+1} from (M + βΔt²H) v = M v* along the directions that contact leaves free.
template <class T>
void OptimizedSolver<T>::solve_implicit() {
  const IntegratorSettings& settings = scene_->integrator;
  solved_ = {};
  if (!(settings.implicitness > 0)) return;
  refresh_stress();  // for the hardened stiffness of particles that were only just loaded
  const double dt_over_h = dt_ / scene_->grid.spacing;
  implicit_.assemble(particles_, nodes_, constants_, settings.implicitness * dt_over_h * dt_over_h,
                     memory_);
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

/// The same between two stages: from the fields that are kept, and back.
template <class T>
void OptimizedSolver<T>::solve_kept_fields() {
  for (std::size_t k = 0; k < nodes_.size(); ++k) implicit_.motion(k) = nodes_.fields(k);
  implicit_.remember_v_star(nodes_);
  solve_implicit();
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    static_cast<NodeMotion<T>&>(nodes_.fields(k)) = implicit_.motion(k);
}

template <class T>
void OptimizedSolver<T>::report_solve(StepReport& report) const {
  report.solver_iterations = solved_.iterations;
  report.solver_residual = solved_.residual;
  report.solver_indefinite = solved_.indefinite;
}

template void OptimizedSolver<float>::solve_implicit();
template void OptimizedSolver<double>::solve_implicit();
template void OptimizedSolver<float>::solve_kept_fields();
template void OptimizedSolver<double>::solve_kept_fields();
template void OptimizedSolver<float>::report_solve(StepReport&) const;
template void OptimizedSolver<double>::report_solve(StepReport&) const;

}  // namespace firn::optimized
