// SPDX-License-Identifier: BSD-3-Clause
#include "bench/step_case.hpp"

namespace firn::bench {

CasePlan step_case(const std::string& suite, const Subject& subject, Deformation deformation,
                   std::size_t particles, bool quick) {
  CasePlan plan;
  plan.description.suite = suite;
  plan.description.name =
      subject.text() + "," + name(deformation) + "," + std::to_string(particles);
  plan.description.title =
      subject.text() + ", " + name(deformation) + ", " + short_count(particles) + " particles";
  subject.describe(plan.description);
  plan.description.parameters.emplace_back("deformation", name(deformation));
  plan.description.parameters.emplace_back("particles", static_cast<double>(particles));
  plan.quick = quick;
  return plan;
}

results::Quantity nanoseconds(const std::string& name, const std::string& meaning) {
  return {name, "ns", meaning, results::Quantity::Better::lower, {}, true};
}

}  // namespace firn::bench
