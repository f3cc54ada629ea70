// SPDX-License-Identifier: BSD-3-Clause
#include "verification/tests/check/solvers.hpp"

namespace firn::test {

Mistaken::Mistaken(Stage stage, Mistake mistake, std::vector<Stage> stops, Precision precision)
    : stage_(stage), mistake_(std::move(mistake)), inner_(make_reference()) {
  traits_.name = "mistaken";
  traits_.precision = precision;
  traits_.semi_implicit = inner_->traits().semi_implicit;
  traits_.stops = std::move(stops);
  if (traits_.stops.empty()) traits_.stops.assign(all_stages.begin(), all_stages.end());
}

void Mistaken::load(const Scene& scene, const State& state) {
  scene_ = &scene;
  state_ = state;
}

TimeStep Mistaken::choose_time_step() {
  inner_->load(*scene_, state_);
  return inner_->choose_time_step();
}

StepReport Mistaken::advance_through(Stage last, double dt) {
  StepReport report;
  for (Stage stage = state_.next;; stage = next(stage)) {
    const State before = state_;
    inner_->load(*scene_, state_);
    report = inner_->advance_through(stage, dt);
    inner_->store(state_);
    spoil(stage, before, state_, dt);
    if (stage == last) return report;
  }
}

void Mistaken::spoil(Stage stage, const State& before, State& after, double dt) {
  if (stage == stage_ && mistake_) mistake_({*scene_, before, after, dt});
}

namespace {

void round_to_float(double& value) { value = static_cast<double>(static_cast<float>(value)); }

template <class Matrix>
void round_to_float(Matrix& matrix) {
  matrix = matrix.template cast<float>().template cast<double>();
}

template <class T>
void round_to_float(std::vector<T>& values) {
  for (T& value : values) round_to_float(value);
}

void round_to_float(State& state) {
  Particles& p = state.particles;
  Grid& g = state.grid;
  round_to_float(p.x), round_to_float(p.v), round_to_float(p.m), round_to_float(p.V_0);
  round_to_float(p.F_E), round_to_float(p.F_P);
  round_to_float(g.m), round_to_float(g.v), round_to_float(g.f), round_to_float(g.v_star);
  round_to_float(g.free_directions), round_to_float(g.v_new);
}

}  // namespace

Rounding::Rounding(Precision claimed, std::vector<Stage> stops)
    : Mistaken(Stage::positions, {}, std::move(stops), claimed) {}

void Rounding::load(const Scene& scene, const State& state) {
  Mistaken::load(scene, state);
  round_to_float(state_);
}

void Rounding::spoil(Stage, const State&, State& after, double) { round_to_float(after); }

}  // namespace firn::test
