// SPDX-License-Identifier: BSD-3-Clause
/// The smallest solver there is: particles that fall and nothing else. It is right for
/// a lone particle and wrong as soon as two meet, and `check` must say so.

#include <cstdio>
#include <memory>

#include "firn/error.hpp"
#include "firn/registry.hpp"
#include "io/mesh/mesh_shape.hpp"
#include "reference/reference_solver.hpp"
#include "verification/check/check.hpp"

namespace {

class FallingParticles final : public firn::Solver {
 public:
  FallingParticles() {
    traits_.name = "falling";
    traits_.stops = {firn::Stage::positions};
  }
  const firn::SolverTraits& traits() const override { return traits_; }

  void load(const firn::Scene& scene, const firn::State& state) override {
    scene_ = &scene;
    state_ = state;
  }
  firn::TimeStep choose_time_step() override {
    return {scene_->time.step, firn::TimeStepBound::fixed};
  }
  firn::StepReport advance_through(firn::Stage, double dt) override {
    firn::Particles& p = state_.particles;
    for (std::size_t q = 0; q < p.size(); ++q) {
      p.v[q] += dt * scene_->gravity;
      p.x[q] = scene_->wrap(p.x[q] + dt * p.v[q]);
    }
    state_.time += dt;
    state_.step += 1;
    firn::StepReport report;
    report.dt = dt;
    return report;
  }
  void store(firn::State& state) const override { state = state_; }

 private:
  firn::SolverTraits traits_;
  const firn::Scene* scene_ = nullptr;
  firn::State state_;
};

firn::State particles(std::size_t n) {
  firn::State state;
  state.particles.resize(n);
  for (std::size_t q = 0; q < n; ++q) {
    state.particles.x[q] = firn::Vec3(0.03 + 0.04 * static_cast<double>(q), 0.02, 1);
    state.particles.v[q] = firn::Vec3(0.5 - static_cast<double>(q), 0, 0);
    state.particles.m[q] = 0.01;
    state.particles.V_0[q] = 2.5e-5;
    state.particles.id[q] = static_cast<std::int64_t>(q);
  }
  return state;
}

}  // namespace

/// A mesh that is not there: what matters is that everything behind the call was linked.
bool missing_mesh_is_told() {
  try {
    firn::load_mesh_shape("missing.obj", 1, firn::Vec3::Zero(), 0.1);
  } catch (const firn::InputError& error) {
    std::printf("%s\n", error.what());
    return true;
  }
  return false;
}

int main() {
  firn::Scene scene;
  scene.name = "outside";
  scene.gravity = {0, 0, -9.81};
  scene.grid.spacing = 0.1;
  scene.time.step = 1e-3;
  scene.materials.emplace_back();

  firn::Registry registry;
  registry.add(firn::reference_entry());
  registry.add({"falling",
                "point masses in free fall",
                {firn::Precision::float64},
                [](const firn::SolverOptions&) { return std::make_unique<FallingParticles>(); }});

  const auto reference = registry.create("reference", {});
  const auto subject = registry.create("falling", {});
  const firn::CheckReport lone = run_check(scene, particles(1), *reference, *subject);
  const firn::CheckReport pair = run_check(scene, particles(2), *reference, *subject);
  std::printf("%s\n%s\n", to_table(lone).c_str(), to_table(pair).c_str());
  return lone.valid() && !pair.valid() && missing_mesh_is_told() ? 0 : 1;
}
