/// Run time against error: exact solutions over h, Δt, the policy for α, and precision.

#include <cmath>

#include "bench/exact.hpp"
#include "bench/suites.hpp"
#include "bench/timing.hpp"
#include "firn/error.hpp"

namespace firn::bench {

namespace {

using results::Quantity;
using Make = ExactProblem (*)(int cells, double cfl, const AlphaPolicy&);

const AlphaPolicy undamped{"1", 1, false}, usual{"0.95", 0.95, false}, pic{"0", 0, false},
    per_time{"rate", 0, true};

/// Runs the problem once. Seconds are those of the steps alone: handing the body
/// force over through store() and load() is the harness's own business.
double seconds_of(const ExactProblem& problem, Solver& solver, State& state) {
  const double dt = problem.scene.time.step;
  solver.load(problem.scene, problem.initial);
  double seconds = 0;
  for (int step = 0; step < problem.steps; ++step) {
    if (interrupted()) throw Interrupted{};
    if (problem.body_force) {
      solver.store(state);
      problem.push(state);
      solver.load(problem.scene, state);
    }
    const double start = seconds_now();
    solver.step(dt);
    seconds += seconds_now() - start;
  }
  solver.store(state);
  return seconds;
}

void plan(const Registry& registry, Make make, const char* problem_name, const Subject& subject,
          int cells, double cfl, const AlphaPolicy& policy, bool quick,
          std::vector<CasePlan>& plans) {
  CasePlan plan;
  results::Case& d = plan.description;
  d.suite = "accuracy";
  d.name = std::string(problem_name) + "," + subject.text() + ",n=" + std::to_string(cells) +
           ",cfl=" + to_text(cfl) + ",alpha=" + policy.name;
  d.title = d.name;
  d.parameters = {{"problem", std::string(problem_name)},
                  {"cells", static_cast<double>(cells)},
                  {"h", 1.0 / cells},
                  {"cfl", cfl},
                  {"alpha_policy", policy.name}};
  subject.describe(d);
  plan.quick = quick;
  plan.run = [=, &registry](results::Case& result) {
    const ExactProblem problem = make(cells, cfl, policy);
    result.parameters.emplace_back("particles", static_cast<double>(problem.X.size()));
    result.parameters.emplace_back("steps", static_cast<double>(problem.steps));
    result.parameters.emplace_back("alpha", problem.scene.flip);
    Quantity error{
        "error", "1",  "‖u_h − u‖/‖u‖ over the particles at the end", Quantity::Better::lower,
        {},      false};
    Quantity time{"time", "s", "wall time of the steps", Quantity::Better::lower, {}, false};
    const auto solver = subject.create(registry);
    State state;
    // Short runs three times; the error is the same each time, bit for bit.
    do {
      time.values.push_back(seconds_of(problem, *solver, state));
      error.values.push_back(problem.relative_error(state));
    } while (time.values.size() < 3 && time.values.back() < 2);
    result.quantities = {error, time};
    for (const double e : error.values)
      if (!(std::abs(e - error.values.front()) == 0)) {
        result.status = results::Status::invalid;
        result.message = "the same run gave another error";
      }
    result.validation = "compared with the closed form";
  };
  plans.push_back(std::move(plan));
}

}  // namespace

void plan_accuracy_suite(const Registry& registry, const Options& options,
                         std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false)) {
    const bool slow = subject.solver == "reference";
    for (const AlphaPolicy& policy : {undamped, usual, pic, per_time})
      for (const int cells : {16, 32, 64, 128})
        plan(registry, standing_wave, "standing wave", subject, cells, 0.4, policy, cells <= 32,
             plans);
    // Smaller steps at the same h: where α is fixed, more of them damp more.
    for (const AlphaPolicy& policy : {undamped, usual, per_time})
      for (const double cfl : {0.05, 0.1, 0.2, 0.8})
        plan(registry, standing_wave, "standing wave", subject, 32, cfl, policy, false, plans);
    for (const AlphaPolicy& policy : {undamped, per_time})
      for (const int cells : {8, 16, 32})
        plan(registry, manufactured, "manufactured", subject, cells, 0.4, policy,
             cells <= (slow ? 8 : 16), plans);
    for (const int cells : {8, 16, 32})
      if (!slow || cells < 32)
        plan(registry, column, "column", subject, cells, 0.4, pic, cells <= 8, plans);
  }
}

}  // namespace firn::bench
