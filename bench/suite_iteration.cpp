// SPDX-License-Identifier: BSD-3-Clause
/// One iteration of the semi-implicit solve in the middle of an impact, beside an explicit step
/// and beside plain scalar code; everything takes turns.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/iteration_cost.hpp"
#include "bench/landing_block.hpp"
#include "bench/plain_hessian.hpp"
#include "bench/suites.hpp"
#include "bench/timing.hpp"
#include "firn/error.hpp"

namespace firn::bench {

namespace {

using results::Quantity;
constexpr double r = 10;  // Δt over Δt_explicit
constexpr int repetitions = 9;

/// The block after so many explicit steps that sound has crossed it once.
State in_mid_impact(Solver& solver, const Scene& scene, double cells) {
  solver.load(scene, initial_state(scene));
  for (int n = 0; n < static_cast<int>(2 * cells); ++n) {
    if (interrupted()) throw Interrupted{};
    solver.step(scene.time.step);
  }
  State state;
  solver.store(state);
  return state;
}

/// One step from `state`, after a small one that finds everything in its place.
StepCost step_from(Solver& solver, const Scene& scene, const State& state, double small) {
  if (interrupted()) throw Interrupted{};
  solver.load(scene, state);
  solver.step(small);
  const double start = seconds_now();
  const StepReport report = solver.step(scene.time.step);
  return {seconds_now() - start, static_cast<double>(report.solver_iterations)};
}

/// The relative residual of the solver's v^{n+1} as the plain operator has it, less the reported.
double disagreement(Solver& solver, const Scene& scene, const State& state) {
  solver.load(scene, state);
  const double dt = scene.time.step;
  const StepReport report = solver.advance_through(Stage::integration, dt);
  State after;
  solver.store(after);
  const Grid& grid = after.grid;
  const PlainHessian plain(scene, state.particles);
  std::vector<Vec3> v(plain.nodes(), Vec3::Zero()), Hv;
  for (std::size_t i = 0; i < grid.size(); ++i) v[plain.place(grid.node[i])] = grid.v_new[i];
  plain.apply(v, Hv);
  double residual = 0, size = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec3 change = dt * dt / grid.m[i] * Hv[plain.place(grid.node[i])];
    residual += grid.m[i] *
                (grid.free_directions[i] * (grid.v_star[i] - grid.v_new[i] - change)).squaredNorm();
    size += grid.m[i] * grid.v_star[i].squaredNorm();
  }
  return std::abs(std::sqrt(residual / size) - report.solver_residual);
}

/// Iterations of one step from each of twelve states that lie `r` explicit steps apart: the
/// block lands, is stopped and rebounds while they pass.
std::vector<Quantity> through_the_impact(Solver& solver, Solver& explicit_solver,
                                         const Scene& plain, const Scene& coarse,
                                         const Scene& fine) {
  std::vector<double> to_coarse, to_fine;
  explicit_solver.load(plain, initial_state(plain));
  for (int k = 0; k < 12; ++k) {
    State state;
    explicit_solver.store(state);
    to_coarse.push_back(step_from(solver, coarse, state, plain.time.step).iterations);
    to_fine.push_back(step_from(solver, fine, state, plain.time.step).iterations);
    for (int n = 0; n < static_cast<int>(r); ++n) explicit_solver.step(plain.time.step);
  }
  const char* const meaning = "from twelve states of the impact, r explicit steps apart";
  return {cost_quantity("iterations through the impact 1e-3", "1", meaning, false, to_coarse),
          cost_quantity("iterations through the impact 1e-6", "1", meaning, false, to_fine)};
}

/// Beyond an explicit run from the same state in the same steps [B per particle].
double extra_memory(const Registry& registry, const Subject& subject, const Scene& plain,
                    const State& state) {
  const auto bytes = [&](const Scene& scene) {
    const auto solver = subject.create(registry);
    solver->load(scene, state);
    for (int n = 0; n < 2; ++n) solver->step(plain.time.step);
    return solver->bytes_per_particle();
  };
  return bytes(in_large_steps(plain, 1, 1e-3)) - bytes(plain);
}

void measure(const Registry& registry, const Options& options, const Subject& subject,
             double youngs_modulus, double cells, results::Case& result) {
  const Scene plain = landing_block(youngs_modulus, cells, options.seed);
  const Scene coarse = in_large_steps(plain, r, 1e-3), fine = in_large_steps(plain, r, 1e-6);
  const Scene at_once = in_large_steps(plain, r, 1e3);  // v* is good enough
  const auto solver = subject.create(registry), explicit_solver = subject.create(registry);
  const State state = in_mid_impact(*explicit_solver, plain, cells);
  const auto n = static_cast<double>(state.particles.size());
  result.parameters.emplace_back("particles", n);

  // v^{n+1} is rounded by eps/2 at most, and B magnifies that: by 1 + r² if explicit steps of
  // h/c are at their limit, ω Δt = 2; hardened snow is stiffer, sixteenfold at the most here.
  const double off = disagreement(*solver, coarse, state);
  const double eps = subject.precision == Precision::float64 ? 0x1p-52 : 0x1p-23;
  const double bound = 8 * r * r * eps;
  result.validation =
      "residual of the solution by the plain operator and by the solver differ by " + to_text(off) +
      ", allowed " + to_text(bound);
  if (!(off <= bound)) {
    result.status = results::Status::invalid;
    result.message = result.validation;
    return;
  }

  IterationCost cost;
  Quantity scalar =
      cost_quantity("plain apply", "ns", "plain scalar operator, per particle", false);
  Quantity gain = cost_quantity("plain apply over iteration", "1",
                                "plain scalar operator in double over one iteration", true);
  Quantity threads = cost_quantity("speed-up of two threads", "1",
                                   "a step to 1e-6 on one thread over the same on two", true);
  gain.better = threads.better = Quantity::Better::higher;

  const PlainHessian operator_(plain, state.particles);
  std::vector<Vec3> u(operator_.nodes(), Vec3(0.1, 0.2, 0.3)), Hu;
  Subject two = subject;
  two.threads = 2;
  const auto pair = options.max_threads != 1 ? two.create(registry) : nullptr;
  for (int i = 0; i < repetitions; ++i) {
    const StepCost a = step_from(*solver, coarse, state, plain.time.step);
    const StepCost b = step_from(*solver, fine, state, plain.time.step);
    double e = 0;
    for (int k = 0; k < 3; ++k)
      e += step_from(*explicit_solver, plain, state, plain.time.step).seconds / 3;
    double p = seconds_now();
    operator_.apply(u, Hu);
    p = seconds_now() - p;
    const double one = cost.add(a, b, e, n);
    const StepCost s = step_from(*solver, at_once, state, plain.time.step);
    if (s.iterations > 0) throw std::logic_error("an iteration where none was asked");
    cost.add_setup(s.seconds, e);
    scalar.values.push_back(1e9 * p / n), gain.values.push_back(p / one);
    if (pair)
      threads.values.push_back(b.seconds / step_from(*pair, fine, state, plain.time.step).seconds);
  }
  result.quantities = cost.quantities();
  for (Quantity& q : through_the_impact(*solver, *explicit_solver, plain, coarse, fine))
    result.quantities.push_back(std::move(q));
  result.quantities.push_back(scalar);
  result.quantities.push_back(gain);
  if (pair) result.quantities.push_back(threads);
  result.quantities.push_back(cost_quantity("extra memory", "B",
                                            "per particle, beyond an explicit run's", false,
                                            {extra_memory(registry, subject, plain, state)}));
}

}  // namespace

void plan_iterations(const Registry& registry, const Options& options, const Subject& subject,
                     std::vector<CasePlan>& plans) {
  for (const double youngs_modulus : {1.4e5, 1e6, 1e7})
    for (const double cells : {8.0, 23.0}) {
      CasePlan plan;
      results::Case& d = plan.description;
      d.suite = "implicit";
      d.name = "iteration," + subject.text() + ",E=" + to_text(youngs_modulus) +
               ",cells=" + to_text(cells);
      d.title = d.name;
      d.parameters = {{"youngs_modulus", youngs_modulus}, {"r", r}};
      subject.describe(d);
      plan.quick = cells < 10 && youngs_modulus == 1e6;
      plan.run = [=, &registry](results::Case& result) {
        measure(registry, options, subject, youngs_modulus, cells, result);
      };
      plans.push_back(std::move(plan));
    }
}

}  // namespace firn::bench
