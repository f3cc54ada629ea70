// SPDX-License-Identifier: BSD-3-Clause
/// What leaving out saves, skip by skip, and what each instruction set brings. Both are
/// chosen by the environment variables that the optimized solver documents.

#include <cstdlib>

#include "bench/needed_work.hpp"
#include "bench/probes.hpp"
#include "bench/skip_situations.hpp"
#include "bench/suites.hpp"
#include "bench/timing.hpp"
#include "firn/error.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

constexpr int repetitions = 9;

/// Sets a variable for the lifetime of a solver's construction.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* old = std::getenv(name)) before_ = old, had_ = true;
    setenv(name, value.c_str(), 1);
  }
  ~Environment() {
    if (had_)
      setenv(name_, before_.c_str(), 1);
    else
      unsetenv(name_);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
  std::string before_;
  bool had_ = false;
};

Timed make_timed(const Registry& registry, const Subject& subject, const Workload& work,
                 const char* variable, const std::string& value) {
  const Environment environment(variable, value);
  return Timed(registry, subject, work);
}

/// Three steps with and without: the same bits.
bool same_result(const Registry& registry, const Subject& subject, const Workload& work,
                 const char* skip) {
  State states[2];
  for (int without = 0; without < 2; ++without) {
    const Environment environment("FIRN_NO_SKIP", without ? skip : "");
    const auto solver = subject.create(registry);
    solver->load(work.scene, work.state);
    for (int n = 0; n < 3; ++n) solver->step(work.scene.time.step);
    solver->store(states[without]);
  }
  const Particles &a = states[0].particles, &b = states[1].particles;
  return a.x == b.x && a.v == b.v && a.F_E == b.F_E && a.F_P == b.F_P;
}

void plan_skip(const Registry& registry, const Options& options, const Subject& subject,
               const char* skip, const Situation& situation, bool applies, bool quick,
               std::vector<CasePlan>& plans) {
  CasePlan plan;
  plan.description.suite = "skips";
  plan.description.name = std::string(skip) + "," + situation.name + "," + subject.text();
  plan.description.title = "without the skip `" + std::string(skip) + "`: " + situation.name;
  subject.describe(plan.description);
  plan.description.parameters.emplace_back("skip", std::string(skip));
  plan.description.parameters.emplace_back("situation", std::string(situation.name));
  plan.description.parameters.emplace_back("applies", applies ? 1.0 : 0.0);
  plan.quick = quick;
  plan.run = [=, &registry](results::Case& result) {
    const Workload work = situation.make(options.seed);
    if (!same_result(registry, subject, work, skip)) {
      result.status = results::Status::invalid;
      result.message = "the result depends on the skip";
      return;
    }
    result.validation = "three steps with and without: the same bits";
    Timed on = make_timed(registry, subject, work, "FIRN_NO_SKIP", "");
    Timed off = make_timed(registry, subject, work, "FIRN_NO_SKIP", skip);
    Quantity saved{"saved",
                   "1",
                   "share of the step that the skip saves: 1 − time with / time without",
                   Quantity::Better::higher,
                   {},
                   false};
    Quantity time{
        "time", "ns", "wall time per particle and step, all skips on", Quantity::Better::lower,
        {},     true};
    Quantity memory{
        "memory saved",           "B", "bytes per particle without the skip, less those with it",
        Quantity::Better::higher, {},  false};
    const auto n = static_cast<double>(work.state.particles.size());
    // Many short pairs: what disturbs one of them does not move the median.
    for (int i = 0; i < 3 * repetitions; ++i) {
      const double with = on.repetition(0.03), without = off.repetition(0.03);
      saved.values.push_back(1 - with / without);
      time.values.push_back(1e9 * with / n);
    }
    memory.values = {off.solver().bytes_per_particle() - on.solver().bytes_per_particle()};
    result.quantities = {saved, time, memory};
  };
  plans.push_back(std::move(plan));
}

void plan_target(const Registry& registry, const Options& options, const Subject& subject,
                 const char* target, Deformation deformation, std::vector<CasePlan>& plans) {
  CasePlan plan;
  plan.description.suite = "targets";
  plan.description.name = std::string(target) + "," + subject.text() + "," + name(deformation);
  plan.description.title = plan.description.name;
  subject.describe(plan.description);
  plan.description.parameters.emplace_back("target", std::string(target));
  plan.description.parameters.emplace_back("deformation", name(deformation));
  plan.quick = false;
  plan.run = [=, &registry](results::Case& result) {
    const Environment environment("FIRN_TARGET", target);
    validate(registry, subject, deformation, options.seed, result);
    if (result.status != results::Status::measured) return;
    const Workload work = block(100'000, deformation, options.seed);
    Timed timed(registry, subject, work);
    Quantity time{"time", "ns", "wall time per particle and step", Quantity::Better::lower,
                  {},     true};
    Quantity factored{"FMA peak, factored count",
                      "1",
                      "operations that the factored step needs, per second, over the multiply-adds "
                      "per second that this instruction set reached right after",
                      Quantity::Better::higher,
                      {},
                      false};
    Quantity plain{"FMA peak, plain count",
                   "1",
                   "flop that plain transfers take, per second, over the flop/s that this "
                   "instruction set reached right after",
                   Quantity::Better::higher,
                   {},
                   false};
    Quantity peak{"peak", "flop/s", "2 flop per lane and multiply-add", Quantity::Better::neither,
                  {},     false};
    const bool single = subject.precision == Precision::float32;
    for (int i = 0; i < repetitions; ++i) {
      const double seconds =
          timed.repetition(0.1) / static_cast<double>(work.state.particles.size());
      // The solver's construction chose the instruction set for the probe, too.
      const double flops = single ? fma_peak_float(1) : fma_peak_double(1);
      time.values.push_back(1e9 * seconds);
      peak.values.push_back(flops);
      factored.values.push_back(factored_share(deformation, seconds, flops));
      plain.values.push_back(plain_share(seconds, flops));
    }
    result.parameters.emplace_back("peak_of", instruction_set());
    result.quantities = {time, factored, plain, peak};
  };
  plans.push_back(std::move(plan));
}

bool target_exists(const Registry& registry, const char* target) {
  const Environment environment("FIRN_TARGET", target);
  try {
    registry.create("optimized", {});
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// Those of the quick set.
bool saves_most(std::string_view skip) {
  return skip == "all" || skip == "box" || skip == "contact" || skip == "volumes";
}

}  // namespace

void plan_skips_suite(const Registry& registry, const Options& options,
                      std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false)) {
    if (subject.solver != "optimized") continue;
    const bool single = subject.precision == Precision::float32;
    for (const SkipCase& c : skip_cases()) {
      for (const Situation& situation : c.applies)
        plan_skip(registry, options, subject, c.skip, situation, true,
                  single && saves_most(c.skip) && &situation == &c.applies.front(), plans);
      for (const Situation& situation : c.does_not)
        plan_skip(registry, options, subject, c.skip, situation, false, false, plans);
    }
  }
}

void plan_targets_suite(const Registry& registry, const Options& options,
                        std::vector<CasePlan>& plans) {
  if (!registry.find("optimized")) return;
  for (const char* target : {"sse4", "avx2", "avx3", "neon"}) {
    if (!target_exists(registry, target)) continue;
    for (const Subject& subject : subjects(registry, options, false))
      if (subject.solver == "optimized")
        for (const Deformation deformation : {Deformation::elastic, Deformation::plastic})
          plan_target(registry, options, subject, target, deformation, plans);
  }
}

}  // namespace firn::bench
