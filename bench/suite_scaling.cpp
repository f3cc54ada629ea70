// SPDX-License-Identifier: BSD-3-Clause
/// Flatness over the number of particles and efficiency over threads, as ratios inside one
/// interleaved run.

#include "bench/step_case.hpp"
#include "bench/suites.hpp"
#include "bench/thread_efficiency.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

/// Two solvers take turns; `ratio` of their times per particle is what the case is about.
void compare(Timed& one, double one_particles, Timed& other, double other_particles, Quantity ratio,
             double factor, results::Case& result) {
  Quantity first = nanoseconds("time", "wall time per particle and step");
  Quantity second = nanoseconds("time of the other", "the same, what it is compared with");
  for (int i = 0; i < step_repetitions; ++i) {
    first.values.push_back(1e9 * one.repetition(least_seconds) / one_particles);
    second.values.push_back(1e9 * other.repetition(least_seconds) / other_particles);
    ratio.values.push_back(factor * second.values.back() / first.values.back());
  }
  first.timed = second.timed = false;
  result.quantities = {ratio, first, second};
}

/// Cost per particle of many against that of few, in one interleaved run.
void plan_flatness(const Registry& registry, const Options& options, const Subject& subject,
                   Deformation deformation, std::size_t many, std::vector<CasePlan>& plans) {
  constexpr std::size_t few = 100'000;
  CasePlan plan = step_case("scaling", subject, deformation, many, false);
  plan.run = [=, &registry](results::Case& result) {
    validate(registry, subject, deformation, options.seed, result);
    if (result.status != results::Status::measured) return;
    const Workload small = block(few, deformation, options.seed);
    const Workload large = block(many, deformation, options.seed);
    Timed one(registry, subject, small), other(registry, subject, large);
    compare(one, static_cast<double>(small.state.particles.size()), other,
            static_cast<double>(large.state.particles.size()),
            {"growth",
             "1",
             "cost per particle over that of 100 k particles",
             Quantity::Better::lower,
             {},
             true},
            1, result);
  };
  plans.push_back(std::move(plan));
}

/// Enough for a median, and short; a case that needs more rounds for its median to be known
/// is run again and adds them (runner.cpp). A large block takes longer to load than to step.
constexpr Rounds quick_rounds{5, 3, 0.03}, full_rounds{9, 3, 0.1}, rounds_of_many{5, 3, 0.1};

void plan_efficiency(const Registry& registry, const Options& options, const Subject& subject,
                     Deformation deformation, std::size_t particles, std::vector<CasePlan>& plans) {
  const bool few = particles <= 100'000;
  CasePlan plan = step_case("scaling", subject, deformation, particles,
                            few && subject.precision == Precision::float32);
  const Rounds rounds = options.quick ? quick_rounds : few ? full_rounds : rounds_of_many;
  plan.run = [=, &registry](results::Case& result) {
    validate(registry, subject, deformation, options.seed, result);
    if (result.status != results::Status::measured) return;
    const Workload work = block(particles, deformation, options.seed);
    result.quantities = measure_efficiency(registry, subject, work, rounds);
  };
  plans.push_back(std::move(plan));
}

}  // namespace

void plan_scaling_suite(const Registry& registry, const Options& options,
                        std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, true)) {
    if (subject.slow()) continue;
    for (const Deformation deformation : {Deformation::elastic, Deformation::plastic}) {
      if (subject.threads > 1) {
        for (const std::size_t particles : {100'000u, 1'000'000u})
          plan_efficiency(registry, options, subject, deformation, particles, plans);
      } else {
        for (const std::size_t particles : {1'000'000u, 4'000'000u})
          plan_flatness(registry, options, subject, deformation, particles, plans);
      }
    }
  }
}

}  // namespace firn::bench
