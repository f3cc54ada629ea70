// SPDX-License-Identifier: BSD-3-Clause
/// The largest stable time step, found by bisection, beside the predicted one.

#include <cmath>
#include <utility>
#include <vector>

#include "bench/study.hpp"
#include "bench/suites.hpp"
#include "firn/error.hpp"
#include "verification/studies/stability.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

using studies::StabilityPoint;

Quantity quantity(const char* name, const char* units, const char* meaning,
                  std::vector<double> values) {
  return {name, units, meaning, Quantity::Better::neither, std::move(values), false};
}

void plan(const Registry& registry, const Subject& subject, const char* varied,
          const StabilityPoint& point, double value, bool quick, std::vector<CasePlan>& plans) {
  CasePlan plan;
  results::Case& d = plan.description;
  d.suite = "stability";
  d.name = subject.text() + "," + varied + "=" + to_text(value);
  d.title = "largest stable step, " + d.name;
  subject.describe(d);
  d.parameters.insert(d.parameters.end(),
                      {{"varied", std::string(varied)},
                       {"value", value},
                       {"alpha", point.alpha},
                       {"E", point.E},
                       {"h", point.h},
                       {"J_P", point.J_P},
                       {"hardening", point.hardening},
                       {"beta", point.beta},
                       {"volumes", std::string(point.estimated ? "estimated" : "exact")},
                       {"particles_per_cell", std::pow(point.per_edge, 3)},
                       {"place", point.place},
                       {"jitter", point.jitter}});
  plan.quick = quick;
  plan.run = [=, &registry](results::Case& result) {
    const studies::StabilityLimit limit =
        studies::largest_stable(study_subject(registry, subject), point);
    const char* outcome = "cΔt/h of a run that turned out so";
    result.quantities = {
        quantity("cfl", "1", "largest stable cΔt/h, hardened c", {limit.cfl}),
        quantity("step", "s", "largest stable Δt", {limit.cfl * point.unit_step()}),
        quantity("stable", "1", outcome, limit.held),
        quantity("unstable", "1", outcome, limit.burst)};
    // The prediction for many is of particles that sample every wave evenly.
    if (point.lone || (point.per_edge > 1 && point.jitter == 0 && !point.estimated)) {
      const double seen =
          std::pow(studies::burst_growth(subject.precision), 1.0 / studies::stability_steps);
      result.quantities.push_back(
          quantity("predicted_cfl", "1", "predicted cΔt/h", {studies::predicted_cfl(point, 1)}));
      result.quantities.push_back(quantity(
          "expected_cfl", "1", "cΔt/h from which the predicted growth is seen in 600 steps",
          {studies::predicted_cfl(point, seen)}));
    }
    result.validation = "perturbed F by 1e-7, 600 steps, unstable where it grew 1e4-fold";
    if (limit.unlimited)
      result.validation += "; no limit up to cΔt/h = " + to_text(studies::largest_tried);
  };
  plans.push_back(std::move(plan));
}

}  // namespace

void plan_stability_suite(const Registry& registry, const Options& options,
                          std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false)) {
    // Float noise is as large as the perturbation; the map is one of the method, in double.
    if (subject.precision != Precision::float64) continue;
    // The reference takes part where the recurrence predicts; elsewhere it would only be slow.
    const bool slow = subject.slow();
    const auto add = [&](const char* varied, double value, bool quick, auto set) {
      StabilityPoint point;
      point.seed = options.seed;
      set(point);
      plan(registry, subject, varied, point, value, quick && !slow, plans);
    };
    for (const double v : {0.0, 0.5, 0.8, 0.95, 1.0})
      if (!slow || v == 0 || v >= 0.95)
        add("alpha", v, true, [v](StabilityPoint& p) { p.alpha = v; });
    // One particle with the mass of a full cell, from a node to the middle of a cell.
    for (const double v : {0.0, 0.25, 0.5})
      for (const bool estimated : {false, true}) {
        if (slow && v != 0.25) continue;
        add(estimated ? "place of a lone particle, estimated volume"
                      : "place of a lone particle, exact volume",
            v, true, [=](StabilityPoint& p) {
              p.lone = true, p.per_edge = 1, p.place = v, p.estimated = estimated;
            });
      }
    if (slow) continue;
    for (const double v : {1.4e3, 1.4e4, 1.4e5, 1.4e6, 1.4e7})
      add("E", v, true, [v](StabilityPoint& p) { p.E = v; });
    for (const double v : {1.4e3, 1.4e5, 1.4e7})
      add("E at h = 0.005", v, false, [v](StabilityPoint& p) { p.E = v, p.h = 0.005; });
    for (const double v : {0.005, 0.02, 0.2})
      add("h", v, true, [v](StabilityPoint& p) { p.h = v; });
    for (const int v : {1, 2, 3}) {
      add("particles per cell", v * v * v, v < 3, [v](StabilityPoint& p) { p.per_edge = v; });
      add("particles per cell, estimated volumes", v * v * v, v < 3, [v](StabilityPoint& p) {
        p.per_edge = v;
        p.estimated = true;
        p.jitter = 1;  // as bodies are sampled
      });
    }
    for (const double v : {0.5, 0.7, 0.9})
      add("J_P", v, true, [v](StabilityPoint& p) { p.J_P = v; });
    for (const double v : {0.0, 5.0, 20.0})
      add("hardening at J_P = 0.8", v, true,
          [v](StabilityPoint& p) { p.hardening = v, p.J_P = 0.8; });
    for (const double v : {0.25, 0.5, 1.0})
      add("jitter", v, true, [v](StabilityPoint& p) { p.jitter = v; });
    if (!subject.traits.semi_implicit) continue;
    for (const double v : {0.1, 0.25, 0.4, 0.5, 1.0})
      add("beta", v, false, [v](StabilityPoint& p) { p.beta = v; });
    for (const double v : {0.1, 0.25, 0.4, 0.5, 1.0})
      add("beta at alpha = 0", v, false, [v](StabilityPoint& p) { p.beta = v, p.alpha = 0; });
  }
}

}  // namespace firn::bench
