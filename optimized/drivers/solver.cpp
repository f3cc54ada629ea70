#include "optimized/drivers/solver.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "firn/error.hpp"
#include "optimized/drivers/target.hpp"
#include "optimized/optimized_solver.hpp"

namespace firn::optimized {

template <class T>
OptimizedSolver<T>::OptimizedSolver(const SolverOptions& options)
    : skips_(SkipSet::from_environment()),
      threads_(options.threads),
      kernels_((select_target_from_environment(), kernels<T>())),
      implicit_(options.threads),
      memory_(static_cast<std::size_t>(options.threads)) {}

template <class T>
const SolverTraits& OptimizedSolver<T>::traits() const {
  static const SolverTraits traits = [] {
    SolverTraits t;
    t.name = "optimized";
    t.precision = sizeof(T) == 4 ? Precision::float32 : Precision::float64;
    t.stops.assign(all_stages.begin(), all_stages.end());
    t.semi_implicit = true;
    return t;
  }();
  return traits;
}

template <class T>
void OptimizedSolver<T>::load(const Scene& scene, const State& state) {
  const Particles& p = state.particles;
  const std::size_t n = p.size();
  require_consistent(scene, p);
  // A mass that is no mass would only hide nodes from the step: they would count as empty.
  for (std::size_t q = 0; q < n; ++q)
    if (!(p.m[q] > 0 && std::isfinite(p.m[q])))
      throw InputError("state", "mass of particle " + std::to_string(q), to_text(p.m[q]),
                       "> 0 and finite");
  scene_ = &scene;
  materials_.clear();
  for (const Material& m : scene.materials)
    materials_.push_back(
        {static_cast<T>(2 * m.mu_0()), static_cast<T>(m.lambda_0() / (2 * m.mu_0())),
         static_cast<T>(m.hardening),
         kernels::ElasticBox<T>::from(m.critical_compression, m.critical_stretch)});
  time_ = state.time, dt_ = state.dt, step_ = state.step, next_ = state.next;
  volumes_unknown_ = std::any_of(p.V_0.begin(), p.V_0.end(), [](double V) { return V == 0; });
  volumes_found_ = false;
  solved_ = {};
  particles_.load(scene, state, !skips_.material);
  nodes_stale_ = stress_stale_ = tiles_stale_ = gathered_stale_ = true;
  prepare(scene.time.adaptive ? scene.time.max_step : scene.time.step);
  dt_ = state.dt;
  if (next_ != Stage::rasterize) {
    refresh_nodes();
    load_grid(state.grid);
  }
}

template <class T>
void OptimizedSolver<T>::prepare(double dt) {
  dt_ = dt;
  constants_.materials = materials_.data();
  constants_.material_count = static_cast<int>(materials_.size());
  constants_.slots = particles_.slots();
  constants_.dt = static_cast<T>(dt);
  constants_.dt_over_h = static_cast<T>(dt / scene_->grid.spacing);
  constants_.minus_inv_h = static_cast<T>(-1 / scene_->grid.spacing);
  for (int a = 0; a < 3; ++a) constants_.gravity_dt[a] = static_cast<T>(dt * scene_->gravity[a]);
  constants_.flip = static_cast<T>(scene_->flip);
  constants_.skip = skips_.kernels;
  contacts_ = Contacts(*scene_, time_, skips_.friction);
  for (ThreadMemory<T>& m : memory_) m.require(particles_.largest_block(), kernels_);
}

template <class T>
void OptimizedSolver<T>::refresh_nodes() {
  if (!nodes_stale_) return;
  nodes_.rebuild(particles_, kernels_.shape, skips_.empty);
  nodes_stale_ = false;
}

template <class T>
void OptimizedSolver<T>::refresh_stress() {
  if (!stress_stale_) return;
  const int n = static_cast<int>(particles_.active().size());
#pragma omp parallel for num_threads(threads_) schedule(dynamic, blocks_per_turn(n, threads_))
  for (int a = 0; a < n; ++a)
    kernels_.stress(
        particles_.view(particles_.block(particles_.active()[static_cast<std::size_t>(a)])),
        constants_);
  stress_stale_ = false;
}

template <class T>
StepReport OptimizedSolver<T>::advance_through(Stage last, double dt) {
  if (number(last) < number(next_))
    throw std::logic_error("advance_through: that stage of the step is over");
  if (!(dt > 0 && std::isfinite(dt)))
    throw InputError("advance_through", "time step", to_text(dt), "> 0 and finite");
  prepare(dt);
  refresh_nodes();
  nodes_.require_fields();
  try {
    for (Stage stage = next_;; stage = next(stage)) {
      run(stage);
      next_ = next(stage);
      if (stage == last) break;
    }
  } catch (SimulationError& error) {
    // Up to the integration nothing but the estimated volumes has been written.
    error.state_intact = number(next_) <= number(Stage::integration) && !volumes_found_;
    next_ = Stage::rasterize;
    solved_ = {};
    throw;
  }
  StepReport report;
  report.dt = dt;
  report.grid_nodes = grid_nodes();
  report_solve(report);
  if (last == Stage::positions) finish_step();
  return report;
}

template <class T>
StepReport OptimizedSolver<T>::step(double dt) {
  if (next_ != Stage::rasterize || volumes_unknown_) return advance_through(Stage::positions, dt);
  if (!(dt > 0 && std::isfinite(dt)))
    throw InputError("step", "time step", to_text(dt), "> 0 and finite");
  prepare(dt);
  refresh_nodes();
  const StepReport report = fused_step();
  finish_step();
  return report;
}

template <class T>
void OptimizedSolver<T>::finish_step() {
  time_ += dt_;
  step_ += 1;
  dt_ = 0;
  next_ = Stage::rasterize;
  volumes_found_ = false;
  solved_ = {};
}

template <class T>
TimeStep OptimizedSolver<T>::choose_time_step() {
  if (!scene_->time.adaptive) return time_step_by_rule(*scene_, 0, 0);
  prepare(scene_->time.max_step);
  refresh_stress();
  double speed2 = 0, sound2 = 0;
  const std::vector<int>& active = particles_.active();
  const int n = static_cast<int>(active.size());
#pragma omp parallel for num_threads(threads_) schedule(dynamic, blocks_per_turn(n, threads_)) \
    reduction(max                                                                              \
              : speed2, sound2)
  for (int a = 0; a < n; ++a) {
    const Block<T>& block = particles_.block(active[static_cast<std::size_t>(a)]);
    for (int i = 0; i < block.count; ++i) {
      double v2 = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const auto v = static_cast<double>(particles_.value(block, i, slot_v + axis));
        v2 += v * v;
      }
      const std::int32_t k = particles_.material(block, i);
      const Material& material = scene_->materials[static_cast<std::size_t>(k)];
      const auto V_0 = static_cast<double>(particles_.value(block, i, slot_V_0));
      const auto m = static_cast<double>(particles_.value(block, i, slot_m));
      // c_p² = (λ + 2μ)/ρ with 2 μ V_p0 at hand; before volumes are known ρ = ρ_0.
      double two_mu = static_cast<double>(particles_.value(block, i, slot_stiffness)) / V_0;
      double rho = m / V_0;
      if (V_0 == 0) {
        Mat3 F_P;
        for (int r = 0; r < 9; ++r)
          F_P(r / 3, r % 3) = static_cast<double>(particles_.value(block, i, slot_E_P + r)) +
                              (r % 4 == 0 ? 1.0 : 0.0);
        const double J_P = F_P.row(0).dot(F_P.row(1).cross(F_P.row(2)));
        two_mu = 2 * material.mu_0() * std::exp(material.hardening * (1 - J_P));
        rho = material.density;
      }
      const double c2 = two_mu * (1 + material.lambda_0() / (2 * material.mu_0())) / rho;
      // Infinity instead of NaN: max would lose it.
      speed2 = std::max(speed2, std::isnan(v2) ? INFINITY : v2);
      sound2 = std::max(sound2, std::isnan(c2) ? INFINITY : c2);
    }
  }
  if (!std::isfinite(speed2) || !std::isfinite(sound2)) {
    SimulationError error(std::isfinite(speed2) ? Stage::grid_forces : Stage::rasterize,
                          SimulationError::Subject::solver, -1,
                          "particle or sound speed is not finite");
    error.state_intact = true;
    throw error;
  }
  return time_step_by_rule(*scene_, std::sqrt(speed2), std::sqrt(sound2));
}

template <class T>
void OptimizedSolver<T>::store(State& state) const {
  state.time = time_, state.dt = dt_, state.step = step_, state.next = next_;
  particles_.store(state.particles);
  state.grid.clear();
  if (next_ != Stage::rasterize) store_grid(state.grid);
}

template <class T>
std::size_t OptimizedSolver<T>::restart_size() const {
  return particles_.restart_size();
}

template <class T>
void OptimizedSolver<T>::store_restart(std::span<std::byte> bytes) const {
  particles_.store_restart(bytes);
}

template <class T>
void OptimizedSolver<T>::load_restart(std::span<const std::byte> bytes) {
  particles_.load_restart(bytes);
  nodes_stale_ = true;
  // The stress came with the particles, unless nobody had computed it yet.
  stress_stale_ = step_ == 0;
}

template <class T>
double OptimizedSolver<T>::bytes_per_particle() const {
  std::size_t sum = particles_.bytes() + nodes_.bytes() + implicit_.bytes();
  for (const ThreadMemory<T>& m : memory_) sum += m.bytes();
  return particles_.size() == 0 ? 0
                                : static_cast<double>(sum) / static_cast<double>(particles_.size());
}

template class OptimizedSolver<float>;
template class OptimizedSolver<double>;

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
