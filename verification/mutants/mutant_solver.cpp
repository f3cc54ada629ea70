// SPDX-License-Identifier: BSD-3-Clause
/// The solver around a patched table of stages.

#include "firn/error.hpp"
#include "reference/grid_nodes.hpp"
#include "verification/mutants/stages.hpp"

namespace firn {

namespace mutants {
namespace {

class MutantSolver final : public Solver {
 public:
  MutantSolver(const Mutant& mutant, const SolverOptions& options)
      : threads_(options.threads), stages_(reference_stages()) {
    mutant.patch(stages_);
    traits_.name = "mutant:" + mutant.name;
    traits_.stops.assign(all_stages.begin(), all_stages.end());
    traits_.semi_implicit = true;
    traits_.pace = Pace::plain;
  }

  const SolverTraits& traits() const override { return traits_; }

  void load(const Scene& scene, const State& state) override {
    scene_ = &scene;
    state_ = state;
    if (state_.next == Stage::rasterize) state_.grid.clear();
    last_good_ = state_;
    in_step_ = false;
    report_ = {};
  }

  TimeStep choose_time_step() override {
    try {
      return stages_.choose_time_step(*scene_, state_.particles);
    } catch (SimulationError& error) {
      error.state_intact = true;
      throw;
    }
  }

  StepReport advance_through(Stage last, double dt) override { return advance(stages_, last, dt); }

  StepReport step(double dt) override {
    return advance(stages_.whole_step ? *stages_.whole_step : stages_, Stage::positions, dt);
  }

  void store(State& state) const override {
    state = state_;
    reference::drop_massless_nodes(state.grid);
  }

 private:
  StepReport advance(const Stages& stages, Stage last, double dt);

  SolverTraits traits_;
  const Scene* scene_ = nullptr;
  int threads_;
  Stages stages_;
  State state_, last_good_;
  reference::Stencils stencils_;
  bool in_step_ = false;
  StepReport report_;
};

StepReport MutantSolver::advance(const Stages& stages, Stage last, double dt) {
  try {
    Grid& grid = state_.grid;
    if (state_.next == Stage::rasterize) {
      grid.clear();
      last_good_ = state_;
      state_.dt = dt;
      report_ = {};
    }
    const Step step{*scene_, state_.time, dt, threads_, state_.particles, stencils_, grid, report_};
    if (!in_step_) {
      const Grid loaded = grid;
      stages.find_nodes(step);
      grid = reference::spread_over(grid.node, loaded);
    }
    in_step_ = true;
    for (Stage stage = state_.next;; stage = next(stage)) {
      stages[stage](step);
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
  report_.grid_nodes = reference::nodes_of_positive_mass(state_.grid);
  if (last == Stage::positions) {
    state_.time += dt;
    state_.step += 1;
    state_.dt = 0;
    last_good_.grid.clear();
    in_step_ = false;
  }
  return report_;
}

std::vector<Mutant> make_mutants() {
  std::vector<Mutant> list;
  add_grid_mutants(list);
  add_stress_mutants(list);
  add_contact_mutants(list);
  add_solve_mutants(list);
  add_deformation_mutants(list);
  add_particle_mutants(list);
  add_kernel_mutants(list);
  add_program_mutants(list);
  add_distance_mutants(list);
  add_scale_mutants(list);
  return list;
}

constexpr const char* prefix = "mutant:";

}  // namespace
}  // namespace mutants

const std::vector<Mutant>& all_mutants() {
  static const std::vector<Mutant> list = mutants::make_mutants();
  return list;
}

namespace {

std::unique_ptr<Solver> make_mutant(const std::string& solver, const SolverOptions& options) {
  if (options.precision != Precision::float64)
    throw InputError("--precision", "not supported by mutants",
                     std::string(name(options.precision)), "double");
  for (const Mutant& mutant : all_mutants())
    if (mutants::prefix + mutant.name == solver)
      return std::make_unique<mutants::MutantSolver>(mutant, options);
  throw InputError("--solver", "unknown mutant", solver,
                   "a name that `firn solvers --mutants` prints");
}

}  // namespace

SolverFamily mutant_family() {
  return {"mutant:NAME", "the reference with one deliberate mistake", begins_with(mutants::prefix),
          make_mutant};
}

}  // namespace firn
