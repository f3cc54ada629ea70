// SPDX-License-Identifier: BSD-3-Clause
#include "verification/suite/whole_steps.hpp"

namespace firn::suite {

namespace {

class WholeSteps final : public Solver {
 public:
  explicit WholeSteps(std::unique_ptr<Solver> solver)
      : solver_(std::move(solver)), traits_(solver_->traits()) {
    traits_.stops = {Stage::positions};
  }

  const SolverTraits& traits() const override { return traits_; }
  void load(const Scene& scene, const State& state) override { solver_->load(scene, state); }
  TimeStep choose_time_step() override { return solver_->choose_time_step(); }
  StepReport advance_through(Stage last, double dt) override {
    return solver_->advance_through(last, dt);
  }
  StepReport step(double dt) override { return solver_->step(dt); }
  StepReport steps(std::int64_t count, double dt) override { return solver_->steps(count, dt); }
  void store(State& state) const override { solver_->store(state); }
  Diagnostics diagnostics(const Scene& scene) const override { return solver_->diagnostics(scene); }
  std::size_t restart_size() const override { return solver_->restart_size(); }
  void store_restart(std::span<std::byte> bytes) const override { solver_->store_restart(bytes); }
  void load_restart(std::span<const std::byte> bytes) override { solver_->load_restart(bytes); }
  double bytes_per_particle() const override { return solver_->bytes_per_particle(); }

 private:
  std::unique_ptr<Solver> solver_;
  SolverTraits traits_;
};

}  // namespace

std::unique_ptr<Solver> in_whole_steps(std::unique_ptr<Solver> solver) {
  return std::make_unique<WholeSteps>(std::move(solver));
}

}  // namespace firn::suite
