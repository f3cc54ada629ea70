// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The plain solver against which others are judged: sequential, double
/// precision, one function per step of the paper. The steps are in steps.hpp; here
/// is what surrounds them: validation, rollback and restart.

#include <memory>

#include "firn/registry.hpp"
#include "firn/solver.hpp"
#include "reference/stencil.hpp"
#include "reference/steps.hpp"

namespace firn::reference {

class ReferenceSolver final : public Solver {
 public:
  const SolverTraits& traits() const override;
  void load(const Scene& scene, const State& state) override;
  TimeStep choose_time_step() override;
  StepReport advance_through(Stage last, double dt) override;
  void store(State& state) const override;
  Diagnostics diagnostics(const Scene& scene) const override;
  double bytes_per_particle() const override;

 private:
  /// Stencils, and the grid on all their nodes.
  void find_nodes();

  const Scene* scene_ = nullptr;  ///< set by load(); outlives the simulation
  /// Its grid holds every node within reach of a particle, also those of zero
  /// mass, as soon as a stage has run.
  State state_;
  State last_good_;          ///< as it was loaded or as the last complete step left it
  Stencils stencils_;        ///< of the positions at the beginning of the step
  bool in_step_ = false;     ///< stencils_ belong to the step under way
  IntegrationReport solve_;  ///< of the step under way
};

}  // namespace firn::reference

namespace firn {

/// Throws InputError unless the precision is double; `threads` has no effect.
std::unique_ptr<Solver> make_reference_solver(const SolverOptions& options);

/// "reference", for the composition root to register.
SolverEntry reference_entry();

}  // namespace firn
