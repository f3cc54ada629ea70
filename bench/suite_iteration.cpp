/// One iteration of the semi-implicit solve in the middle of an impact, beside an explicit step
/// and beside plain scalar code; everything takes turns.

#include <algorithm>
#include <cmath>

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

struct Step {
  double seconds, iterations;
};
/// One step from `state`, after a small one that finds everything in its place.
Step step_from(Solver& solver, const Scene& scene, const State& state, double small) {
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
  const auto solver = subject.create(registry), explicit_solver = subject.create(registry);
  const State state = in_mid_impact(*explicit_solver, plain, cells);
  const auto n = static_cast<double>(state.particles.size());
  result.parameters.emplace_back("particles", n);

  // Float leaves the rounding of v^{n+1}, magnified by B, some r².
  const double off = disagreement(*solver, coarse, state);
  const double bound = subject.precision == Precision::float64 ? 1e-9 : 1e-4;
  result.validation =
      "residual of the solution by the plain operator and by the solver differ by " + to_text(off) +
      ", allowed " + to_text(bound);
  if (!(off <= bound)) {
    result.status = results::Status::invalid;
    return;
  }

  const auto quantity = [](const char* name, const char* units, const char* meaning, bool timed) {
    return Quantity{name, units, meaning, Quantity::Better::lower, {}, timed};
  };
  Quantity its_3 = quantity("iterations 1e-3", "1", "of one step, tolerance 1e-3", false);
  Quantity its_6 = quantity("iterations 1e-6", "1", "of one step, tolerance 1e-6", false);
  Quantity iteration = quantity("iteration", "ns", "one iteration, per particle", false);
  Quantity step = quantity("explicit step", "ns", "one explicit step, per particle", false);
  Quantity ratio =
      quantity("iteration over explicit step", "1", "one iteration in explicit steps", true);
  Quantity setup = quantity("set-up", "1",
                            "a semi-implicit step without its iterations and without an explicit "
                            "step, in explicit steps",
                            false);
  Quantity scalar = quantity("plain apply", "ns", "plain scalar operator, per particle", false);
  Quantity gain = quantity("plain apply over iteration", "1",
                           "plain scalar operator in double over one iteration", true);
  gain.better = Quantity::Better::higher;
  Quantity threads = quantity("speed-up of two threads", "1",
                              "a step to 1e-6 on one thread over the same on two", true);
  threads.better = Quantity::Better::higher;

  const PlainHessian operator_(plain, state.particles);
  std::vector<Vec3> u(operator_.nodes(), Vec3(0.1, 0.2, 0.3)), Hu;
  Subject two = subject;
  two.threads = 2;
  const auto pair = options.max_threads != 1 ? two.create(registry) : nullptr;
  for (int i = 0; i < repetitions; ++i) {
    const Step a = step_from(*solver, coarse, state, plain.time.step);
    const Step b = step_from(*solver, fine, state, plain.time.step);
    double e = 0;
    for (int k = 0; k < 3; ++k)
      e += step_from(*explicit_solver, plain, state, plain.time.step).seconds / 3;
    double p = seconds_now();
    operator_.apply(u, Hu);
    p = seconds_now() - p;
    const double one = (b.seconds - a.seconds) / (b.iterations - a.iterations);
    its_3.values.push_back(a.iterations), its_6.values.push_back(b.iterations);
    iteration.values.push_back(1e9 * one / n), step.values.push_back(1e9 * e / n);
    ratio.values.push_back(one / e);
    setup.values.push_back((a.seconds - a.iterations * one) / e - 1);
    scalar.values.push_back(1e9 * p / n), gain.values.push_back(p / one);
    if (pair)
      threads.values.push_back(b.seconds / step_from(*pair, fine, state, plain.time.step).seconds);
  }
  result.quantities = {its_3, its_6, iteration, step, ratio, setup, scalar, gain};
  if (pair) result.quantities.push_back(threads);
  result.quantities.push_back({"extra memory",
                               "B",
                               "per particle, beyond an explicit run's",
                               Quantity::Better::lower,
                               {extra_memory(registry, subject, plain, state)},
                               false});
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
