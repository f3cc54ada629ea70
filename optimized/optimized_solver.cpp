// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/optimized_solver.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "firn/error.hpp"
#include "optimized/drivers/diagnostics.hpp"
#include "optimized/drivers/fused.hpp"
#include "optimized/drivers/grid_fields.hpp"
#include "optimized/drivers/staged.hpp"
#include "optimized/drivers/step.hpp"
#include "optimized/drivers/time_step.hpp"
#include "optimized/target.hpp"

namespace firn::optimized {

namespace {

template <class T>
Simulation<T> make_simulation(const SolverOptions& options) {
  select_target_from_environment();  // before any kernel is asked for
  return {.skips = SkipSet::from_environment(),
          .threads = options.threads,
          .kernels = kernels<T>(),
          .implicit_kernels = implicit_kernels<T>(),
          .memory = std::vector<ThreadMemory<T>>(options.threads)};
}

void require_valid(const Scene& scene, const Particles& p) {
  require_consistent(scene, p);
  // A mass that is no mass would only hide nodes from the step: they would count as empty.
  for (std::size_t q = 0; q < p.size(); ++q)
    if (!(p.m[q] > 0 && std::isfinite(p.m[q])))
      throw InputError("state", "mass of particle " + std::to_string(q), to_text(p.m[q]),
                       "> 0 and finite");
}

void require_time_step(const char* where, double dt) {
  if (!(dt > 0 && std::isfinite(dt)))
    throw InputError(where, "time step", to_text(dt), "> 0 and finite");
}

template <class T>
MaterialConstants<T> constants_of(const Material& m) {
  return {static_cast<T>(2 * m.mu_0()), static_cast<T>(m.lambda_0() / (2 * m.mu_0())),
          static_cast<T>(m.hardening),
          kernels::ElasticBox<T>::from(m.critical_compression, m.critical_stretch)};
}

}  // namespace

/// The interface of every solver, on top of the two drivers.
template <class T>
class OptimizedSolver final : public Solver {
 public:
  explicit OptimizedSolver(const SolverOptions& options) : sim_(make_simulation<T>(options)) {}

  const SolverTraits& traits() const override {
    static const SolverTraits traits = [] {
      SolverTraits t;
      t.name = "optimized";
      t.precision = sizeof(T) == sizeof(float) ? Precision::float32 : Precision::float64;
      t.stops.assign(all_stages.begin(), all_stages.end());
      t.semi_implicit = true;
      return t;
    }();
    return traits;
  }

  void load(const Scene& scene, const State& state) override {
    require_valid(scene, state.particles);
    sim_.scene = &scene;
    sim_.materials.clear();
    for (const Material& m : scene.materials) sim_.materials.push_back(constants_of<T>(m));
    sim_.time = state.time, sim_.step = state.step, sim_.next = sim_.entered = state.next;
    const std::vector<double>& V_0 = state.particles.V_0;
    const bool known = std::find(V_0.begin(), V_0.end(), 0.0) == V_0.end();
    sim_.volumes = known ? Volumes::known : Volumes::unknown;
    sim_.stress_stale = true;
    sim_.solved = {};
    sim_.particles.load(scene, state, !sim_.skips.material);
    begin_step(sim_, scene.time.adaptive ? scene.time.max_step : scene.time.step);
    sim_.dt = state.dt;
    if (sim_.next == Stage::rasterize) return;
    sim_.nodes.follow(sim_.particles, sim_.kernels.shape, sim_.skips.empty);
    load_grid(sim_, state.grid);
  }

  TimeStep choose_time_step() override { return optimized::choose_time_step(sim_); }

  StepReport advance_through(Stage last, double dt) override {
    if (number(last) < number(sim_.next))
      throw std::logic_error("advance_through: that stage of the step is over");
    require_time_step("advance_through", dt);
    return run_stages(sim_, last, dt);
  }

  StepReport step(double dt) override {
    if (sim_.next != Stage::rasterize || sim_.volumes == Volumes::unknown)
      return advance_through(Stage::positions, dt);
    require_time_step("step", dt);
    return fused_step(sim_, dt);
  }

  void store(State& state) const override {
    state.time = sim_.time, state.dt = sim_.dt, state.step = sim_.step, state.next = sim_.next;
    sim_.particles.store(state.particles);
    state.grid.clear();
    if (sim_.next != Stage::rasterize) store_grid(sim_, state.grid);
  }

  Diagnostics diagnostics(const Scene& scene) const override {
    // The stress of a state that was only just loaded is not known yet.
    if (sim_.stress_stale) return Solver::diagnostics(scene);
    return diagnostics_of(sim_);
  }

  std::size_t restart_size() const override { return sim_.particles.restart_size(); }

  void store_restart(std::span<std::byte> bytes) const override {
    sim_.particles.store_restart(bytes);
  }

  void load_restart(std::span<const std::byte> bytes) override {
    sim_.particles.load_restart(bytes);
    // The stress comes with the particles, unless no step has computed it yet.
    sim_.stress_stale = sim_.step == 0;
  }

  double bytes_per_particle() const override {
    std::size_t sum = sim_.particles.bytes() + sim_.nodes.bytes() + sim_.implicit.bytes();
    for (const ThreadMemory<T>& m : sim_.memory) sum += m.bytes();
    const std::size_t n = sim_.particles.size();
    return n == 0 ? 0 : static_cast<double>(sum) / static_cast<double>(n);
  }

 private:
  Simulation<T> sim_;
};

}  // namespace firn::optimized

namespace firn {

std::unique_ptr<Solver> make_optimized_solver(const SolverOptions& options) {
  if (options.threads < 1)
    throw InputError("--threads", "number of threads", std::to_string(options.threads), ">= 1");
  if (options.precision == Precision::float32)
    return std::make_unique<optimized::OptimizedSolver<float>>(options);
  return std::make_unique<optimized::OptimizedSolver<double>>(options);
}

SolverEntry optimized_entry() {
  return {"optimized",
          "blocks, SIMD and threads: float or double, the same bits at any number of threads",
          {Precision::float64, Precision::float32},
          make_optimized_solver};
}

}  // namespace firn
