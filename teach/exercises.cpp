// SPDX-License-Identifier: BSD-3-Clause
#include "teach/exercises.hpp"

#include <cstdlib>
#include <utility>

#include "firn/error.hpp"
#include "verification/mutants/mutants.hpp"

namespace firn::teach {

namespace {

constexpr std::string_view prefix = "exercise:";

/// Another solver under another name.
class Masked final : public Solver {
 public:
  Masked(std::string name, std::unique_ptr<Solver> solver)
      : traits_(solver->traits()), solver_(std::move(solver)) {
    traits_.name = std::move(name);
  }
  const SolverTraits& traits() const override { return traits_; }
  void load(const Scene& scene, const State& state) override { solver_->load(scene, state); }
  TimeStep choose_time_step() override { return solver_->choose_time_step(); }
  StepReport advance_through(Stage last, double dt) override {
    return solver_->advance_through(last, dt);
  }
  StepReport step(double dt) override { return solver_->step(dt); }
  void store(State& state) const override { solver_->store(state); }
  Diagnostics diagnostics(const Scene& scene) const override { return solver_->diagnostics(scene); }
  std::size_t restart_size() const override { return solver_->restart_size(); }
  void store_restart(std::span<std::byte> bytes) const override { solver_->store_restart(bytes); }
  void load_restart(std::span<const std::byte> bytes) override { solver_->load_restart(bytes); }
  double bytes_per_particle() const override { return solver_->bytes_per_particle(); }

 private:
  SolverTraits traits_;
  std::unique_ptr<Solver> solver_;
};

}  // namespace

const std::vector<Exercise>& exercises() {
  static const std::vector<Exercise> list = {
      {"gravity_divided_by_mass", "tiny_impact"},  {"limits_swapped", "tiny_impact"},
      {"last_particle_forgotten", "tiny_impact"},  {"flip_from_v_star", "tiny_impact"},
      {"hardening_by_J_E", "tiny_impact"},         {"friction_by_whole_speed", "tiny_impact"},
      {"moved_with_the_grid", "tiny_impact"},      {"growth_on_the_wrong_side", "tiny_impact"},
      {"known_volumes_recomputed", "tiny_impact"}, {"pressure_without_J", "tiny_impact"},
      {"delta_R_dropped", "stiff_block"},          {"sigma_for_its_inverse", "tiny_impact"},
  };
  return list;
}

namespace {

std::unique_ptr<Solver> make_exercise(const std::string& solver, const SolverOptions& options) {
  const std::string text = solver.substr(prefix.size());
  char* end = nullptr;
  const long number = std::strtol(text.c_str(), &end, 10);
  const auto count = static_cast<long>(exercises().size());
  if (text.empty() || *end != '\0' || number < 1 || number > count) {
    std::string range = "exercise:1 .. exercise:";
    range.append(std::to_string(count));
    throw InputError("--solver", "unknown exercise", solver, range);
  }
  std::string mutant = "mutant:";
  mutant.append(exercises()[static_cast<std::size_t>(number - 1)].mutant);
  return std::make_unique<Masked>(solver, mutant_family().create(mutant, options));
}

}  // namespace

SolverFamily exercise_family() {
  return {"exercise:NUMBER", "a planted bug of a lesson", begins_with(std::string(prefix)),
          make_exercise};
}

}  // namespace firn::teach
