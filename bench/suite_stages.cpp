// SPDX-License-Identifier: BSD-3-Clause
/// Where the time of a step goes, and how near its halves come to the machine's ceilings.

#include <algorithm>
#include <cmath>

#include "bench/needed_work.hpp"
#include "bench/probes.hpp"
#include "bench/statistics.hpp"
#include "bench/step_case.hpp"
#include "bench/suites.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

Quantity share(const std::string& name, const std::string& meaning, double work,
               const std::vector<double>& nanoseconds, double peak) {
  Quantity q{name, "1", meaning, Quantity::Better::higher, {}, false};
  for (const double ns : nanoseconds) q.values.push_back(work / (1e-9 * ns) / peak);
  return q;
}

/// The step and its two halves against the machine's ceilings, which are measured in the
/// same case. Stages 1 to 3 and 7 to 10 are taken together: whether a solver sums forces
/// with the masses, or gathers twice where it stops in between, is its own affair.
void add_shares(const Subject& subject, Deformation deformation, const Quantity& whole,
                const std::vector<Stage>& stops, const std::vector<Quantity>& per_stage,
                results::Case& result) {
  const bool single = subject.precision == Precision::float32;
  const double peak = 0.5 * (single ? fma_peak_float(1) : fma_peak_double(1));  // operations/s
  const double bandwidth = triad_bandwidth(1);
  const NeededWork n = needed_work(deformation);
  const auto sum = [&](Stage first, Stage last) {
    std::vector<double> ns(whole.values.size(), 0.0);
    for (std::size_t s = 0; s < stops.size(); ++s)
      if (number(stops[s]) >= number(first) && number(stops[s]) <= number(last))
        for (std::size_t i = 0; i < ns.size(); ++i) ns[i] += per_stage[s].values[i];
    return ns;
  };
  const std::string of = "needed operations per second over the measured peak of multiply-adds: ";
  result.quantities.push_back(share("FMA peak, whole step", of + "fastest path",
                                    n.to_grid + n.to_particles, whole.values, peak));
  result.quantities.push_back(share("FMA peak, stages 1 to 3", of + "particles to grid", n.to_grid,
                                    sum(Stage::rasterize, Stage::grid_forces), peak));
  result.quantities.push_back(share("FMA peak, stages 7 to 10", of + "grid to particles",
                                    n.to_particles, sum(Stage::deformation, Stage::positions),
                                    peak));
  result.quantities.push_back(
      share("bandwidth, whole step",
            "bytes of the particles' state that must be read and written, per second, over the "
            "measured bandwidth",
            n.values * (single ? 4 : 8), whole.values, bandwidth));
}

/// Time between two stops belongs to the stages in between, named by the last one.
void plan_stages(const Registry& registry, const Options& options, const Subject& subject,
                 Deformation deformation, std::size_t particles, std::vector<CasePlan>& plans) {
  CasePlan plan = step_case("stages", subject, deformation, particles,
                            !subject.slow() || deformation == Deformation::plastic);
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
    for (int i = 0; i < step_repetitions; ++i) {
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
    if (stops.size() == all_stages.size())
      add_shares(subject, deformation, whole, stops, per_stage, result);
    // A stage of a nanosecond is no number to be judged by its relative spread.
    for (Quantity& stage : per_stage) {
      stage.timed = median(stage.values) > 0.02 * median(whole.values);
      result.quantities.push_back(stage);
    }
  };
  plans.push_back(std::move(plan));
}

}  // namespace

void plan_stages_suite(const Registry& registry, const Options& options,
                       std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false))
    for (const Deformation deformation : {Deformation::elastic, Deformation::plastic})
      plan_stages(registry, options, subject, deformation, 100'000, plans);
}

}  // namespace firn::bench
