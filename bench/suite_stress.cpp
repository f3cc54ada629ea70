// SPDX-License-Identifier: BSD-3-Clause
/// Hard cases: a few particles each, twenty steps. A solver must never return a NaN or an
/// infinity without an error.

#include "bench/study.hpp"
#include "bench/suites.hpp"
#include "firn/error.hpp"
#include "verification/studies/stress_list.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

using studies::Expected;
using studies::Situation;
using studies::StressOutcome;

void measure(const Registry& registry, const Subject& subject, const Situation& situation,
             results::Case& result) {
  const StressOutcome outcome = studies::run(study_subject(registry, subject), situation);
  result.parameters.emplace_back("outcome", outcome.text());
  result.validation = outcome.text();
  const bool stops = situation.expected == Expected::stops;
  double mass = 0;
  for (const double m : situation.state.particles.m) mass += m;
  const double scale = stops ? 0 : mass * outcome.fastest;
  const Vec3 change =
      studies::momentum(outcome.state.particles) - studies::momentum(situation.state.particles);
  const double momentum_error = scale > 0 ? change.norm() / scale : 0;
  // A few hundred roundings a step at most: 64 nodes, up to 100 particles.
  const double eps = subject.precision == Precision::float32 ? 0x1p-23 : 0x1p-52;
  const double allowed = situation.steps * 200 * eps;
  if (outcome.ending == StressOutcome::Ending::silent || outcome.stopped() != stops)
    result.message = outcome.text();
  else if (!stops && !(momentum_error <= allowed))
    result.message = "momentum off by " + to_text(momentum_error) + ", allowed " + to_text(allowed);
  if (!result.message.empty()) {
    result.status = results::Status::invalid;
    return;
  }
  if (!stops)
    result.quantities = {{"momentum",
                          "1",
                          "change of Σ m v over 20 steps, over Σ m max|v|",
                          Quantity::Better::neither,
                          {momentum_error},
                          false}};
}

}  // namespace

void plan_stress_suite(const Registry& registry, const Options& options,
                       std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false))
    for (const Situation& situation : studies::cell_situations()) {
      CasePlan plan;
      results::Case& d = plan.description;
      d.suite = "stress";
      d.name = situation.name + "," + subject.text();
      d.title = d.name;
      d.parameters = {
          {"situation", situation.name},
          {"expected", std::string(situation.expected == Expected::stops ? "stops" : "goes on")}};
      subject.describe(d);
      plan.quick = true;
      plan.run = [&registry, subject, situation](results::Case& result) {
        measure(registry, subject, situation, result);
      };
      plans.push_back(std::move(plan));
    }
}

}  // namespace firn::bench
