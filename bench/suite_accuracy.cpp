// SPDX-License-Identifier: BSD-3-Clause
/// Run time against error: exact solutions over h, Δt, the policy for α, precision,
/// explicit and semi-implicit.

#include <cmath>
#include <stdexcept>

#include "bench/study.hpp"
#include "bench/suites.hpp"
#include "firn/error.hpp"
#include "verification/studies/convergence.hpp"

namespace firn::bench {

namespace {

using exact::column, exact::manufactured, exact::standing_wave;
using results::Quantity;
using studies::AlphaPolicy, studies::Integration;
using studies::undamped, studies::usual, studies::pic, studies::per_time;
using studies::vortex_of_15_percent;

struct Point {
  const char* problem;
  studies::MakeProblem make;
  int cells;
  double cfl;
  AlphaPolicy policy;
  Integration integration = {};
  bool quick = false;
};

void measure(const Registry& registry, const Subject& subject, const Point& point,
             results::Case& result) {
  studies::ExactProblem problem = point.make(point.cells, point.cfl, point.policy);
  point.integration.set(problem.scene);
  result.parameters.emplace_back("particles", static_cast<double>(problem.X.size()));
  result.parameters.emplace_back("steps", static_cast<double>(problem.steps));
  result.parameters.emplace_back("alpha", problem.scene.flip);
  Quantity error{
      "error", "1",  "‖u_h − u‖/‖u‖ over the particles at the end", Quantity::Better::lower,
      {},      false};
  Quantity time{"time", "s", "wall time of the steps", Quantity::Better::lower, {}, false};
  const studies::Subject studied = study_subject(registry, subject);
  const auto solver = studied.create();
  double total = 0;
  // Short runs three times; the error is the same each time, bit for bit.
  do {
    const studies::ConvergenceRun run = studies::run_exact(studied, *solver, problem);
    time.values.push_back(run.seconds);
    error.values.push_back(run.error);
    total += run.seconds;
  } while (time.values.size() < 3 && total < 0.5);
  for (const double e : error.values) {
    if (!std::isfinite(e)) throw std::runtime_error("the displacements are not finite");
    if (e == error.values.front()) continue;
    result.status = results::Status::invalid;
    result.message = "the same run gave another error";
  }
  result.quantities = {error, time};
  result.validation = "compared with the closed form; " + std::to_string(error.values.size()) +
                      " runs, the same error to the last bit";
}

void plan(const Registry& registry, const Subject& subject, const Point& point,
          std::vector<CasePlan>& plans) {
  CasePlan plan;
  results::Case& d = plan.description;
  d.suite = "accuracy";
  d.name = std::string(point.problem) + "," + subject.text() + ",n=" + std::to_string(point.cells) +
           ",cfl=" + to_text(point.cfl) + ",alpha=" + point.policy.name;
  if (point.integration.semi_implicit) d.name += "," + point.integration.text();
  d.title = d.name;
  const double edge = std::string(point.problem) == "vortex" ? 2.5 : 1;
  d.parameters = {{"problem", std::string(point.problem)},
                  {"integration", point.integration.text()},
                  {"cells", static_cast<double>(point.cells)},
                  {"h", edge / point.cells},
                  {"cfl", point.cfl},
                  {"alpha_policy", point.policy.name}};
  subject.describe(d);
  plan.quick = point.quick;
  plan.run = [=, &registry](results::Case& result) { measure(registry, subject, point, result); };
  plans.push_back(std::move(plan));
}

/// What a slow solver is asked for: enough to see that its errors are everybody's.
void plan_slow(std::vector<Point>& points) {
  for (const int cells : {16, 32, 64})
    points.push_back({"standing wave", standing_wave, cells, 0.4, undamped, {}, cells <= 32});
  for (const int cells : {8, 16})
    points.push_back({"manufactured solution", manufactured, cells, 0.4, undamped, {}, cells <= 8});
  points.push_back({"column", column, 8, 0.4, pic, {}, true});
  for (const int cells : {16, 32})
    points.push_back({"vortex", vortex_of_15_percent, cells, 0.4, usual, {}, cells <= 16});
}

void plan_explicit(bool with_finest, std::vector<Point>& points) {
  for (const AlphaPolicy& policy : {undamped, usual, pic, per_time})
    for (const int cells : {16, 32, 64, 128})
      points.push_back({"standing wave", standing_wave, cells, 0.4, policy, {}, cells <= 64});
  // Smaller steps at the same h: where α is fixed, more of them damp more.
  for (const AlphaPolicy& policy : {undamped, usual, per_time})
    for (const double cfl : {0.05, 0.1, 0.2, 0.8})
      points.push_back({"standing wave", standing_wave, 32, cfl, policy});
  for (const AlphaPolicy& policy : {undamped, per_time})
    for (const int cells : {8, 16, 32})
      if (cells < 32 || with_finest)
        points.push_back(
            {"manufactured solution", manufactured, cells, 0.4, policy, {}, cells <= 8});
  for (const int cells : {8, 16, 32})
    points.push_back({"column", column, cells, 0.4, pic, {}, cells <= 16});
  for (const AlphaPolicy& policy : {undamped, usual, pic})
    for (const int cells : {16, 32, 64, 128})
      if (cells < 128 || (with_finest && policy.value > 0))
        points.push_back({"vortex", vortex_of_15_percent, cells, 0.4, policy, {}, cells <= 16});
}

/// Where semi-implicit steps might pay: beyond the explicit limit.
void plan_implicit(bool slow, std::vector<Point>& points) {
  for (const double beta : {0.5, 1.0})
    for (const int cells : {32, 64, 128})
      for (const double cfl : {0.4, 1.0, 3.0}) {
        if (slow && (cells > 32 || cfl < 3)) continue;
        const bool quick = !slow && cells == 64 && cfl >= 1;
        points.push_back(
            {"standing wave", standing_wave, cells, cfl, undamped, {true, beta}, quick});
      }
  if (slow) return;
  for (const int cells : {16, 32, 64})
    for (const double cfl : {0.4, 1.0, 3.0})
      points.push_back({"vortex", vortex_of_15_percent, cells, cfl, usual, {true, 0.5}});
}

}  // namespace

void plan_accuracy_suite(const Registry& registry, const Options& options,
                         std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false)) {
    const bool slow = subject.slow();
    std::vector<Point> points;
    if (slow)
      plan_slow(points);
    else
      plan_explicit(subject.precision == Precision::float64, points);
    if (subject.traits.semi_implicit) plan_implicit(slow, points);
    for (const Point& point : points) plan(registry, subject, point, plans);
  }
}

}  // namespace firn::bench
