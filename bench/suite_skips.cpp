/// What leaving out saves, skip by skip, and what each instruction set brings. Both are
/// chosen by the environment variables that the optimized solver documents.

#include <cstdlib>

#include "bench/suites.hpp"
#include "bench/timing.hpp"
#include "firn/error.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

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

struct Situation {
  const char* name;
  Workload (*make)(std::uint64_t seed);
};

Workload undeformed(std::uint64_t seed) {
  Workload work = block(100'000, Deformation::elastic, seed);
  Particles& p = work.state.particles;
  for (std::size_t at = 0; at < p.size(); ++at) {
    p.F_E[at] = Mat3::Identity();
    p.v[at] = Vec3(0, 0, -500);
  }
  work.scene.colliders.push_back(Collider{});
  work.scene.colliders.back().shape = HalfSpace{Vec3(0, 0, -1), Vec3::UnitZ()};
  return work;
}

/// The elastic block with a ball inside: every block of nodes near the ball is tested.
Workload touching(std::uint64_t seed) {
  Workload work = block(100'000, Deformation::elastic, seed);
  work.scene.colliders.push_back(Collider{});
  work.scene.colliders.back().shape = Sphere{Vec3(0.5, 0.5, 0.5), 0.3};
  work.scene.colliders.back().friction = 0.3;
  work.scene.colliders.back().velocity = work.state.particles.v.front();
  return work;
}

constexpr Situation situations[] = {
    {"falling, undeformed", undeformed},
    {"elastic", [](std::uint64_t seed) { return block(100'000, Deformation::elastic, seed); }},
    {"elastic, around a collider", touching},
    {"plastic", [](std::uint64_t seed) { return block(100'000, Deformation::plastic, seed); }},
};

Timed make_timed(const Registry& registry, const Subject& subject, const Workload& work,
                 const char* variable, const std::string& value) {
  const Environment environment(variable, value);
  return Timed(registry, subject, work);
}

void plan_skip(const Registry& registry, const Options& options, const Subject& subject,
               const char* skip, const Situation& situation, std::vector<CasePlan>& plans) {
  CasePlan plan;
  plan.description.suite = "skips";
  plan.description.name = std::string(skip) + "," + situation.name + "," + subject.text();
  plan.description.title = "without the skip `" + std::string(skip) + "`: " + situation.name;
  subject.describe(plan.description);
  plan.description.parameters.emplace_back("skip", std::string(skip));
  plan.description.parameters.emplace_back("situation", std::string(situation.name));
  plan.quick = subject.precision == Precision::float32;
  plan.run = [=, &registry](results::Case& result) {
    const Workload work = situation.make(options.seed);
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
    const auto n = static_cast<double>(work.state.particles.size());
    for (int i = 0; i < 9; ++i) {
      const double with = on.repetition(0.1), without = off.repetition(0.1);
      saved.values.push_back(1 - with / without);
      time.values.push_back(1e9 * with / n);
    }
    result.quantities = {saved, time};
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
    for (int i = 0; i < 9; ++i)
      time.values.push_back(1e9 * timed.repetition(0.1) /
                            static_cast<double>(work.state.particles.size()));
    result.quantities = {time};
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

}  // namespace

void plan_skips_suite(const Registry& registry, const Options& options,
                      std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false)) {
    if (subject.solver != "optimized") continue;
    for (const char* skip : {"box", "contact", "undeformed", "all"})
      for (const Situation& situation : situations)
        plan_skip(registry, options, subject, skip, situation, plans);
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
