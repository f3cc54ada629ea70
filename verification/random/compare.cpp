#include "verification/random/compare.hpp"

#include "firn/error.hpp"
#include "verification/check/check.hpp"

namespace firn {

Comparison compare(const RandomCase& c, const MakeSolver& reference, const MakeSolver& subject) {
  CheckOptions options;
  options.steps = c.steps;
  options.start_step = c.start_step;
  const auto ours = reference(), theirs = subject();
  try {
    const CheckReport report = run_check(c.scene, *ours, *theirs, options);
    Comparison result;
    result.compared = report.compared();
    result.largest_in_bounds = report.largest_in_bounds();
    if (report.valid()) return result;
    const Divergence& d = *report.first_divergence;
    const bool beyond_float =
        report.precision == Precision::float32 &&
        d.message.find("hardening exp(xi (1 - J_P)) is not finite") != std::string::npos;
    result.agreement = beyond_float ? Agreement::beyond_float : Agreement::invalid;
    result.message = "step " + std::to_string(d.step) + ", stage " +
                     stage_range(d.from, d.through) +
                     (d.field ? ", " + std::string(name(*d.field)) : "") + ": " + d.message;
    return result;
  } catch (const SimulationError& error) {
    return {Agreement::reference_failed, error.what(), 0, 0};
  }
}

}  // namespace firn
