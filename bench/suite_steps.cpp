/// Particle-steps per second: whole steps over sizes and threads, stage by stage,
/// and against the reference in one interleaved run.

#include <algorithm>
#include <cmath>

#include "bench/statistics.hpp"
#include "bench/suites.hpp"
#include "bench/timing.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

constexpr int repetitions = 9;

/// A repetition long enough that starting and stopping the threads is below 1 %.
constexpr double least_seconds = 0.15;

CasePlan plan_case(const std::string& suite, const Subject& subject, Deformation deformation,
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

Quantity nanoseconds(const std::string& name, const std::string& meaning) {
  return {name, "ns", meaning, Quantity::Better::lower, {}, true};
}

void plan_steps(const Registry& registry, const Options& options, const Subject& subject,
                Deformation deformation, std::size_t particles, std::vector<CasePlan>& plans) {
  CasePlan plan = plan_case("steps", subject, deformation, particles, particles <= 100'000);
  plan.run = [=, &registry](results::Case& result) {
    validate(registry, subject, deformation, options.seed, result);
    if (result.status != results::Status::measured) return;
    const Workload work = block(particles, deformation, options.seed);
    const auto n = static_cast<double>(work.state.particles.size());
    Timed timed(registry, subject, work);
    Quantity time = nanoseconds("time", "wall time per particle and step");
    for (int i = 0; i < repetitions; ++i)
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

/// Time between two stops belongs to the stages in between, named by the last one.
void plan_stages(const Registry& registry, const Options& options, const Subject& subject,
                 Deformation deformation, std::size_t particles, std::vector<CasePlan>& plans) {
  CasePlan plan = plan_case("stages", subject, deformation, particles, true);
  plan.run = [=, &registry](results::Case& result) {
    validate(registry, subject, deformation, options.seed, result);
    if (result.status != results::Status::measured) return;
    const Workload work = block(particles, deformation, options.seed);
    const auto n = static_cast<double>(work.state.particles.size());
    Timed timed(registry, subject, work);
    Solver& solver = timed.solver();
    const std::vector<Stage> stops = solver.traits().stops;
    std::vector<Quantity> per_stage;
    for (std::size_t i = 0; i < stops.size(); ++i) {
      const int first = i == 0 ? 1 : number(stops[i - 1]) + 1;
      std::string stages = std::string(firn::name(static_cast<Stage>(first)));
      if (first != number(stops[i])) stages += " to " + std::string(firn::name(stops[i]));
      per_stage.push_back(nanoseconds(stages, "wall time per particle, stages run one by one"));
    }
    Quantity whole = nanoseconds("whole step", "wall time per particle, fastest path");
    // Long enough to be timed, and not longer: the reference takes 0.3 s for one step.
    const double once = timed.repetition(0);
    const int steps = std::clamp(static_cast<int>(std::ceil(0.1 / once)), 1,
                                 std::min(10, work.steps_allowed / 3));
    for (int i = 0; i < repetitions; ++i) {
      solver.load(work.scene, work.state);
      solver.step(work.scene.time.step);
      std::vector<double> seconds(stops.size(), 0.0);
      for (int step = 0; step < steps; ++step)
        for (std::size_t s = 0; s < stops.size(); ++s) {
          const double start = seconds_now();
          solver.advance_through(stops[s], work.scene.time.step);
          seconds[s] += seconds_now() - start;
        }
      for (std::size_t s = 0; s < stops.size(); ++s)
        per_stage[s].values.push_back(1e9 * seconds[s] / (n * steps));
      const double start = seconds_now();
      for (int step = 0; step < steps; ++step) solver.step(work.scene.time.step);
      whole.values.push_back(1e9 * (seconds_now() - start) / (n * steps));
      if (interrupted()) throw Interrupted{};
    }
    result.quantities.push_back(whole);
    // A stage of a nanosecond is no number to be judged by its relative spread.
    for (Quantity& stage : per_stage) {
      stage.timed = median(stage.values) > 0.02 * median(whole.values);
      result.quantities.push_back(stage);
    }
  };
  plans.push_back(std::move(plan));
}

/// Repetitions of both solvers take turns, so that a slow minute of the machine hits both.
void plan_speedup(const Registry& registry, const Options& options, const Subject& subject,
                  Deformation deformation, std::size_t particles, std::vector<CasePlan>& plans) {
  CasePlan plan = plan_case("speedup", subject, deformation, particles, true);
  plan.run = [=, &registry](results::Case& result) {
    validate(registry, subject, deformation, options.seed, result);
    if (result.status != results::Status::measured) return;
    const Workload work = block(particles, deformation, options.seed);
    const auto n = static_cast<double>(work.state.particles.size());
    Timed timed(registry, subject, work);
    Timed reference(registry, {"reference", Precision::float64, 1}, work);
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
      if (subject.solver == "reference" && particles > 1'000'000) continue;
      for (const Deformation deformation : {Deformation::elastic, Deformation::plastic})
        plan_steps(registry, options, subject, deformation, particles, plans);
    }
}

void plan_stages_suite(const Registry& registry, const Options& options,
                       std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false))
    for (const Deformation deformation : {Deformation::elastic, Deformation::plastic})
      plan_stages(registry, options, subject, deformation, 100'000, plans);
}

void plan_speedup_suite(const Registry& registry, const Options& options,
                        std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, true))
    if (subject.solver != "reference" && registry.find("reference"))
      for (const Deformation deformation : {Deformation::elastic, Deformation::plastic})
        plan_speedup(registry, options, subject, deformation, 100'000, plans);
}

}  // namespace firn::bench
