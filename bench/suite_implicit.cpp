// SPDX-License-Identifier: BSD-3-Clause
/// Semi-implicit against explicit steps: iterations, what one of them costs, wall time per
/// simulated second, and time to a given error, at three stiffnesses.

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/iteration_cost.hpp"
#include "bench/landing_block.hpp"
#include "bench/suites.hpp"
#include "bench/timing.hpp"
#include "firn/error.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

CasePlan plan_case(const std::string& kind, const Subject& subject, double youngs_modulus,
                   double factor) {
  CasePlan plan;
  results::Case& d = plan.description;
  d.suite = "implicit";
  d.name = kind + "," + subject.text() + ",E=" + to_text(youngs_modulus) + ",r=" + to_text(factor);
  d.title = d.name;
  d.parameters = {{"youngs_modulus", youngs_modulus}, {"r", factor}};
  subject.describe(d);
  return plan;
}

/// Seconds per step and iterations per step of a few steps from `state`.
struct Stepped : StepCost {
  double worst_residual = 0;
};
Stepped take_steps(Solver& solver, const Scene& scene, const State& state, int steps) {
  if (interrupted()) throw Interrupted{};
  solver.load(scene, state);
  solver.step(scene.time.step);  // allocates and sorts
  Stepped result;
  const double start = seconds_now();
  for (int n = 0; n < steps; ++n) {
    const StepReport report = solver.step(scene.time.step);
    result.iterations += static_cast<double>(report.solver_iterations) / steps;
    result.worst_residual = std::max(result.worst_residual, report.solver_residual);
  }
  result.seconds = (seconds_now() - start) / steps;
  return result;
}

/// What a step and an iteration cost. Runs at two tolerances and explicit ones take turns;
/// see IterationCost.
void plan_cost(const Registry& registry, const Options& options, const Subject& subject,
               double youngs_modulus, double factor, double cells, bool quick,
               std::vector<CasePlan>& plans) {
  CasePlan plan = plan_case("cost", subject, youngs_modulus, factor);
  plan.description.name += ",cells=" + to_text(cells);
  plan.description.title = plan.description.name;
  plan.quick = quick;
  plan.run = [=, &registry](results::Case& result) {
    const Scene plain = landing_block(youngs_modulus, cells, options.seed);
    const Scene coarse = in_large_steps(plain, factor, 1e-3);
    const Scene fine = in_large_steps(plain, factor, 1e-6);
    const State state = initial_state(plain);
    const auto n = static_cast<double>(state.particles.size());
    result.parameters.emplace_back("particles", n);
    const auto solver = subject.create(registry);
    const bool slow = subject.slow();
    const int steps = factor > 20 ? 1 : 2;

    IterationCost cost;
    Quantity implicit_wall = cost_quantity(
        "implicit wall", "s/s", "wall time per simulated second, semi-implicit at 1e-3", false);
    Quantity explicit_wall = cost_quantity(
        "explicit wall", "s/s", "wall time per simulated second, explicit at its limit", false);
    Quantity pays =
        cost_quantity("implicit over explicit", "1",
                      "wall time per simulated second, semi-implicit over explicit", true);
    double residual_3 = 0, residual_6 = 0, bytes = 0, explicit_bytes = 0;
    for (int i = 0; i < (slow ? 1 : 3); ++i) {
      const Stepped a = take_steps(*solver, coarse, state, steps);
      bytes = solver->bytes_per_particle();
      const Stepped b = take_steps(*solver, fine, state, steps);
      const auto fresh = subject.create(registry);
      const Stepped e = take_steps(*fresh, plain, state, slow ? 1 : 10);
      explicit_bytes = fresh->bytes_per_particle();
      residual_3 = std::max(residual_3, a.worst_residual);
      residual_6 = std::max(residual_6, b.worst_residual);
      cost.add(a, b, e.seconds, n);
      implicit_wall.values.push_back(a.seconds / coarse.time.step);
      explicit_wall.values.push_back(e.seconds / plain.time.step);
      pays.values.push_back(implicit_wall.values.back() / explicit_wall.values.back());
    }
    result.validation = "true relative residuals " + to_text(residual_3) + " and " +
                        to_text(residual_6) + ", recomputed by the solver";
    if (!(residual_3 <= 1e-3 && residual_6 <= 1e-6)) {
      result.status = results::Status::invalid;
      result.message = "a residual is larger than its tolerance";
    }
    result.quantities = cost.quantities();
    for (const Quantity& q : {implicit_wall, explicit_wall, pays}) result.quantities.push_back(q);
    if (bytes > 0)
      result.quantities.push_back(cost_quantity("extra memory", "B",
                                                "per particle, beyond an explicit run's", false,
                                                {bytes - explicit_bytes}));
  };
  plans.push_back(std::move(plan));
}

/// Relative error of the particles' displacements from rigid motion at `end` against a run
/// in explicit steps an eighth of the limit, and the wall time. factor ≤ 1: explicit steps.
/// α falls with Δt so that PIC damps as much per second in every run.
void plan_error(const Registry& registry, const Options& options, const Subject& subject,
                double youngs_modulus, double factor, double tolerance, bool quick,
                std::vector<CasePlan>& plans) {
  CasePlan plan = plan_case("error", subject, youngs_modulus, factor);
  plan.description.name += ",tolerance=" + to_text(tolerance);
  plan.description.title = plan.description.name;
  plan.description.parameters.emplace_back("tolerance", tolerance);
  plan.quick = quick;
  plan.run = [=, &registry](results::Case& result) {
    const Scene plain = landing_block(youngs_modulus, 8, options.seed);
    const State start = initial_state(plain);
    const double end = 0.024;  // 100 explicit steps at E = 1e6: the block has been braked
    result.parameters.emplace_back("particles", static_cast<double>(start.particles.size()));
    const auto run = [&](Scene scene, double& seconds) {
      const auto steps = static_cast<int>(std::ceil(end / scene.time.step - 1e-9));
      const double dt = end / steps;
      scene.flip = std::pow(0.95, dt / plain.time.step);  // the same damping per second
      const auto solver = subject.create(registry);
      solver->load(scene, start);
      const double begin = seconds_now();
      for (int n = 0; n < steps; ++n) {
        if (interrupted()) throw Interrupted{};
        solver->step(dt);
      }
      seconds = seconds_now() - begin;
      State state;
      solver->store(state);
      return state.particles;
    };
    const auto scaled = [&](double f) {
      Scene scene = plain;
      scene.time.step *= f;
      return scene;
    };
    const Scene scene = factor > 1 ? in_large_steps(plain, factor, tolerance) : scaled(factor);
    double unused = 0;
    const Particles exact = run(scaled(0.125), unused);
    Quantity time = cost_quantity("time", "s", "wall time of the steps", false);
    Particles found;
    // Short runs three times; a solver is a function, so the error is the same each time.
    for (double total = 0; time.values.empty() || (time.values.size() < 3 && total < 0.5);) {
      time.values.push_back(0);
      found = run(scene, time.values.back());
      total += time.values.back();
    }
    double difference = 0, size = 0;
    for (std::size_t p = 0; p < exact.size(); ++p) {
      const Vec3 rigid =
          start.particles.x[p] + end * start.particles.v[p] + 0.5 * end * end * plain.gravity;
      difference += (found.x[p] - exact.x[p]).squaredNorm();
      size += (exact.x[p] - rigid).squaredNorm();
    }
    result.quantities = {
        {"error",
         "1",
         "of the displacements from free fall, against explicit steps an eighth of the limit",
         Quantity::Better::lower,
         {std::sqrt(difference / size)},
         false},
        time};
    result.validation = "every semi-implicit step met its tolerance";
  };
  plans.push_back(std::move(plan));
}

}  // namespace

void plan_implicit_suite(const Registry& registry, const Options& options,
                         std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false)) {
    if (!subject.traits.semi_implicit) continue;
    const bool slow = subject.slow();
    for (const double youngs_modulus : {1.4e5, 1e6, 1e7})
      for (const double factor : {10.0, 50.0, 100.0}) {
        // 4 k particles everywhere; 97 k show that iterations do not grow with the number, in
        // steps in which no particle crosses more than about two cells.
        plan_cost(registry, options, subject, youngs_modulus, factor, 8, !slow && factor < 20,
                  plans);
        if (!slow && (factor < 20 || (youngs_modulus == 1e7 && factor < 100)))
          plan_cost(registry, options, subject, youngs_modulus, factor, 23, false, plans);
      }
    if (slow) continue;
    plan_iterations(registry, options, subject, plans);
    for (const double youngs_modulus : {1.4e5, 1e6, 1e7}) {
      for (const double factor : {0.5, 1.0})
        plan_error(registry, options, subject, youngs_modulus, factor, 0, youngs_modulus == 1e6,
                   plans);
      for (const double factor : {2.0, 5.0, 10.0, 20.0})
        for (const double tolerance : {1e-2, 1e-3, 1e-6})
          plan_error(registry, options, subject, youngs_modulus, factor, tolerance,
                     tolerance > 5e-3 && youngs_modulus == 1e6, plans);
    }
  }
}

}  // namespace firn::bench
