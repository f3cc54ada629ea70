// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The smallest solver that has everything a run driver can trip over: hidden
/// digits that only the restart data carry, an adaptive time step, failures on
/// demand.

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>

#include "firn/error.hpp"
#include "firn/solver.hpp"
#include "verification/support/through_float.hpp"

namespace firn::fixtures {

/// Particles in free flight, v ← v + Δt g, x ← x + Δt v summed with Kahan's
/// compensation; F_E grows with time. Without its restart data (the
/// compensations) a continued run differs within a few steps.
class BallisticSolver : public Solver {
 public:
  /// Called before step `n` (0, 1, …) with its Δt; may throw.
  using Failure = std::function<void(std::int64_t step, double dt)>;

  explicit BallisticSolver(Precision precision = Precision::float64) {
    traits_.name = "ballistic";
    traits_.precision = precision;
    traits_.stops = {Stage::positions};
    traits_.semi_implicit = true;
  }

  const SolverTraits& traits() const override { return traits_; }

  void load(const Scene& scene, const State& state) override {
    scene_ = &scene;
    state_ = state;
    lost_digits_.assign(state.particles.size(), Vec3::Zero());
    if (traits_.precision == Precision::float32) state_.particles = through_float(state.particles);
    ++loads;
  }

  TimeStep choose_time_step() override {
    double fastest = 0;
    for (const Vec3& v : state_.particles.v) fastest = std::max(fastest, v.norm());
    return time_step_by_rule(*scene_, fastest, 0);
  }

  StepReport advance_through(Stage, double dt) override {
    ++steps_tried;
    if (failure) failure(state_.step, dt);
    Particles& p = state_.particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
      p.v[i] += dt * scene_->gravity;
      round_to_precision(p.v[i]);
      const Vec3 move = dt * p.v[i] - lost_digits_[i];
      Vec3 sum = p.x[i] + move;
      round_to_precision(sum);
      lost_digits_[i] = (sum - p.x[i]) - move;
      p.x[i] = sum;
      p.F_E[i](0, 1) = std::ldexp(static_cast<double>(state_.step % 1000 + 1), -12);
      if (p.V_0[i] == 0) p.V_0[i] = 1;
    }
    if (poison_at_step == state_.step) p.v[p.size() / 2][1] = std::nan("");
    state_.time += dt;
    ++state_.step;
    StepReport report;
    report.dt = dt;
    report.grid_nodes = 64 + state_.step;
    report.solver_iterations = state_.step % 7;
    return report;
  }

  void store(State& state) const override { state = state_; }

  std::size_t restart_size() const override { return lost_digits_.size() * sizeof(Vec3); }
  void store_restart(std::span<std::byte> bytes) const override {
    std::memcpy(bytes.data(), lost_digits_.data(), bytes.size());
  }
  void load_restart(std::span<const std::byte> bytes) override {
    std::memcpy(static_cast<void*>(lost_digits_.data()), bytes.data(), bytes.size());
  }

  Failure failure;
  std::int64_t poison_at_step = -1;  ///< a velocity becomes NaN in that step
  std::int64_t loads = 0, steps_tried = 0;

  /// What a failing step leaves behind when it says state_intact = false.
  void scramble() { state_.particles.x.assign(state_.particles.size(), Vec3::Constant(1e9)); }

 private:
  void round_to_precision(Vec3& a) const {
    if (traits_.precision == Precision::float32)
      for (int c = 0; c < 3; ++c) a[c] = through_float(a[c]);
  }

  const Scene* scene_ = nullptr;
  SolverTraits traits_;
  State state_;
  std::vector<Vec3> lost_digits_;
};

}  // namespace firn::fixtures
