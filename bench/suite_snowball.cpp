// SPDX-License-Identifier: BSD-3-Clause
/// The plastic snowball has no formal order of convergence: bands over seeds, never an order.

#include <cmath>
#include <stdexcept>

#include "bench/study.hpp"
#include "bench/suites.hpp"
#include "verification/studies/snowball.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

}  // namespace

void plan_snowball_suite(const Registry& registry, const Options& options,
                         std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false))
    for (const int resolution : {4, 6, 9}) {
      if (subject.slow() && resolution > 4) continue;
      CasePlan plan;
      plan.description.suite = "snowball";
      plan.description.name = subject.text() + ",resolution=" + std::to_string(resolution);
      plan.description.title = "bands over seeds, " + plan.description.name;
      subject.describe(plan.description);
      plan.description.parameters.emplace_back("resolution", static_cast<double>(resolution));
      plan.quick = !subject.slow() && resolution <= 4;
      plan.run = [=, &registry, seed = options.seed](results::Case& result) {
        Quantity center{
            "center", "m",  "height of the centre of mass at 0.15 s", Quantity::Better::neither,
            {},       false};
        Quantity width{"width", "m",  "extent along x at 0.15 s", Quantity::Better::neither,
                       {},      false};
        Quantity J_P{"J_P", "1",  "mean det F_P, by mass, at 0.15 s", Quantity::Better::neither,
                     {},    false};
        Quantity contact{
            "contact", "s",  "when the momentum leaves free fall by 1 %", Quantity::Better::neither,
            {},        false};
        std::vector<studies::SnowballOutcome> outcomes;
        for (std::uint64_t i = 0; i < 5; ++i) {
          outcomes.push_back(studies::drop_snowball(study_subject(registry, subject),
                                                    studies::snowball(resolution, seed + i)));
          const studies::SnowballOutcome& o = outcomes.back();
          center.values.push_back(o.center);
          width.values.push_back(o.width);
          J_P.values.push_back(o.J_P);
          contact.values.push_back(o.contact);
        }
        Quantity mass{"mass",
                      "1",
                      "share of the mass in other cells of 0.1 m than in the mean of the seeds",
                      Quantity::Better::neither,
                      studies::misplaced(outcomes),
                      false};
        result.quantities = {center, width, J_P, contact, mass};
        for (const Quantity& quantity : result.quantities)
          for (const double value : quantity.values)
            if (!std::isfinite(value)) throw std::runtime_error(quantity.name + " is not finite");
        result.validation = "values of five seeds, no repetitions";
      };
      plans.push_back(std::move(plan));
    }
}

}  // namespace firn::bench
