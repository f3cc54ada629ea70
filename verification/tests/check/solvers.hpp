// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Solvers that the tests of the checker need: the reference, by its name, and
/// subjects which are the reference with one mistake in one stage.

#include <functional>
#include <memory>
#include <string>

#include "firn/solver.hpp"
#include "verification/support/builtin_registry.hpp"

namespace firn::test {

using fixtures::builtin_registry;
using fixtures::make_reference;

/// What a mistake may look at and spoil: the state before the stage and after it.
struct StageRun {
  const Scene& scene;
  const State& before;
  State& after;
  double dt;
};
using Mistake = std::function<void(const StageRun&)>;

/// The reference, but `mistake` is applied to the result of `stage`. It stops where
/// it is told to, by default everywhere.
class Mistaken : public Solver {
 public:
  Mistaken(Stage stage, Mistake mistake, std::vector<Stage> stops = {},
           Precision precision = Precision::float64);

  const SolverTraits& traits() const override { return traits_; }
  void load(const Scene& scene, const State& state) override;
  TimeStep choose_time_step() override;
  StepReport advance_through(Stage last, double dt) override;
  void store(State& state) const override { state = state_; }

 protected:
  /// After every stage; the base class applies the mistake after its stage.
  virtual void spoil(Stage stage, const State& before, State& after, double dt);

  const Scene* scene_ = nullptr;
  State state_;

 private:
  Stage stage_;
  Mistake mistake_;
  SolverTraits traits_;
  std::unique_ptr<Solver> inner_;
};

/// The reference with every number rounded to float on the way in and after every
/// stage: what a careful float solver can reach at best.
class Rounding final : public Mistaken {
 public:
  explicit Rounding(Precision claimed, std::vector<Stage> stops = {});
  void load(const Scene& scene, const State& state) override;

 private:
  void spoil(Stage stage, const State& before, State& after, double dt) override;
};

}  // namespace firn::test
