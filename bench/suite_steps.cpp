// SPDX-License-Identifier: BSD-3-Clause
/// Particle-steps per second: whole steps over sizes and threads, and against the reference
/// in one interleaved run.

#include "bench/step_case.hpp"
#include "bench/suites.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

void plan_steps(const Registry& registry, const Options& options, const Subject& subject,
                Deformation deformation, std::size_t particles, std::vector<CasePlan>& plans) {
  CasePlan plan = step_case("steps", subject, deformation, particles, particles <= 100'000);
  plan.run = [=, &registry](results::Case& result) {
    validate(registry, subject, deformation, options.seed, result);
    if (result.status != results::Status::measured) return;
    const Workload work = block(particles, deformation, options.seed);
    const auto n = static_cast<double>(work.state.particles.size());
    Timed timed(registry, subject, work);
    Quantity time = nanoseconds("time", "wall time per particle and step");
    for (int i = 0; i < step_repetitions; ++i)
      time.values.push_back(1e9 * timed.repetition(least_seconds) / n);
    Quantity rate{"rate",
                  "particle-steps/s",
                  "particles times steps per second of wall time",
                  Quantity::Better::higher,
                  {},
                  true};
    for (const double ns : time.values) rate.values.push_back(1e9 / ns);
    result.quantities = {time, rate};
    if (const double bytes = timed.solver().bytes_per_particle(); bytes > 0)
      result.quantities.push_back({"memory",
                                   "B",
                                   "memory of the solver per particle",
                                   Quantity::Better::lower,
                                   {bytes},
                                   false});
  };
  plans.push_back(std::move(plan));
}

/// Repetitions of both solvers take turns, so that a slow minute of the machine hits both.
void plan_speedup(const Registry& registry, const Options& options, const Subject& subject,
                  Deformation deformation, std::size_t particles, std::vector<CasePlan>& plans) {
  CasePlan plan = step_case("speedup", subject, deformation, particles, subject.threads == 1);
  plan.run = [=, &registry](results::Case& result) {
    validate(registry, subject, deformation, options.seed, result);
    if (result.status != results::Status::measured) return;
    const Workload work = block(particles, deformation, options.seed);
    const auto n = static_cast<double>(work.state.particles.size());
    Timed timed(registry, subject, work);
    Timed reference(registry, {reference_name}, work);
    Quantity ratio{"speedup",
                   "1",
                   "time of the reference (double, one thread) over time of this solver",
                   Quantity::Better::higher,
                   {},
                   true};
    Quantity mine = nanoseconds("time", "wall time per particle and step");
    Quantity theirs = nanoseconds("reference time", "the same, reference");
    for (int i = 0; i < 7; ++i) {
      theirs.values.push_back(1e9 * reference.repetition(least_seconds) / n);
      mine.values.push_back(1e9 * timed.repetition(least_seconds) / n);
      ratio.values.push_back(theirs.values.back() / mine.values.back());
    }
    mine.timed = theirs.timed = false;  // the ratio is what this case is about
    result.quantities = {ratio, mine, theirs};
  };
  plans.push_back(std::move(plan));
}

}  // namespace

void plan_steps_suite(const Registry& registry, const Options& options,
                      std::vector<CasePlan>& plans) {
  for (const std::size_t particles : {100'000u, 1'000'000u, 4'000'000u})
    for (const Subject& subject : subjects(registry, options, true)) {
      // One step of 4 M particles takes the reference half a minute.
      if (subject.slow() && particles > 1'000'000) continue;
      for (const Deformation deformation : {Deformation::elastic, Deformation::plastic})
        plan_steps(registry, options, subject, deformation, particles, plans);
    }
}

void plan_speedup_suite(const Registry& registry, const Options& options,
                        std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, true))
    if (subject.solver != reference_name && registry.find(reference_name))
      for (const Deformation deformation : {Deformation::elastic, Deformation::plastic})
        plan_speedup(registry, options, subject, deformation, 100'000, plans);
}

}  // namespace firn::bench
