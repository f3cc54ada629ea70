/// What each solver does where it hurts: a few particles each, twenty steps. The only
/// thing that is never right is a number that is not finite and nobody told.

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/suites.hpp"
#include "bench/timing.hpp"
#include "firn/error.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

constexpr double h = 0.05, nan = std::numeric_limits<double>::quiet_NaN();
constexpr int steps = 20;

enum class Expected { goes_on, stops };

struct Situation {
  const char* name;
  Expected expected;
  void (*change)(Scene&, Particles&);
};

/// One particle in the middle of a cell, at rest, of an eighth of the cell's volume.
void add(Particles& p, const Vec3& x, const Vec3& v = Vec3::Zero()) {
  Particles one;
  one.resize(1);
  one.x[0] = x;
  one.v[0] = v;
  one.V_0[0] = h * h * h / 8;
  one.m[0] = 400 * one.V_0[0];
  one.id[0] = static_cast<std::int64_t>(p.size());
  p.append(one);
}

/// 2×2×2 particles of one cell, the particle in question first.
void fill_cell(Particles& p) {
  for (int i = 0; i < 8; ++i)
    add(p, h * Vec3(0.25 + 0.5 * (i & 1), 0.25 + 0.25 * (i & 2), 0.25 + 0.125 * (i & 4)));
}

constexpr Situation situations[] = {
    {"no particle", Expected::goes_on, [](Scene&, Particles&) {}},
    {"a lone particle", Expected::goes_on,
     [](Scene&, Particles& p) { add(p, h * Vec3(0.3, 0.4, 0.6), Vec3(1, 2, 3)); }},
    {"two particles, 10 h apart", Expected::goes_on,
     [](Scene&, Particles& p) {
       add(p, h * Vec3(0.3, 0.4, 0.6), Vec3(1, 0, 0));
       add(p, h * Vec3(10.3, 0.4, 0.6), Vec3(-1, 0, 0));
     }},
    {"100 particles in one place", Expected::goes_on,
     [](Scene&, Particles& p) {
       for (int i = 0; i < 100; ++i) add(p, h * Vec3(0.3, 0.4, 0.6), Vec3(0, 0, i % 2 ? 1 : -1));
     }},
    {"a particle on a node", Expected::goes_on,
     [](Scene&, Particles& p) { add(p, h * Vec3(2, -1, 0), Vec3(1, 1, 1)); }},
    {"on the face of the periodic domain", Expected::goes_on,
     [](Scene& scene, Particles& p) {
       scene.grid.periodic = Vec3::Constant(8 * h);
       add(p, Vec3::Zero(), Vec3(-1, 0, 0));
       add(p, h * Vec3(7.999999999, 4, 4), Vec3(1, 0, 0));
     }},
    {"faster than a cell per step", Expected::goes_on,
     [](Scene&, Particles& p) {
       fill_cell(p);
       for (Vec3& v : p.v) v = Vec3(3.3 * h / 1e-4, 0, 0);
     }},
    {"leaves the representable domain", Expected::stops,
     [](Scene&, Particles& p) { add(p, h * Vec3(0.3, 0.4, 0.6), Vec3(h * 0x1p30 / 1e-4, 0, 0)); }},
    {"Δt ∇v = −I", Expected::goes_on,
     [](Scene& scene, Particles& p) {
       fill_cell(p);
       for (std::size_t at = 0; at < p.size(); ++at)
         p.v[at] = -(p.x[at] - Vec3::Constant(0.5 * h)) / scene.time.step;
     }},
    {"det F_E < 0, elastic", Expected::goes_on,
     [](Scene& scene, Particles& p) {
       fill_cell(p);
       Material& m = scene.materials.back();
       m.hardening = 0;
       m.critical_compression = m.critical_stretch = std::numeric_limits<double>::infinity();
       p.F_E[0] = Vec3(1, 1, -1).asDiagonal();
     }},
    // The return mapping moves σ_3 from −1 to 1 − θ_c; J_P < −1 stiffens by e²⁰, and bursts.
    {"det F_E < 0, plastic", Expected::stops,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.F_E[0] = Vec3(1, 1, -1).asDiagonal();
     }},
    {"F_E of rank 2", Expected::goes_on,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.F_E[0] = Vec3(1, 1, 0).asDiagonal();
     }},
    {"F_E = 0", Expected::goes_on,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.F_E[0].setZero();
     }},
    {"stiffness overflows: ξ(1 − J_P) = 730", Expected::stops,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.F_E[0] = 1.001 * Mat3::Identity();
       p.F_P[0] = Vec3(1, 1, -72).asDiagonal();
     }},
    {"a velocity is not a number", Expected::stops,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.v[3].y() = nan;
     }},
    {"a position is not a number", Expected::stops,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.x[3].y() = nan;
     }},
    {"F_E is not a number", Expected::stops,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.F_E[3](1, 2) = nan;
     }},
    {"F_P is infinite", Expected::stops,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.F_P[3](0, 0) = std::numeric_limits<double>::infinity();
     }},
};

Scene plain_scene() {
  Scene scene;
  scene.name = "stress";
  scene.grid.spacing = h;
  scene.time.step = 1e-4;
  scene.time.end = 1;
  scene.time.frames_per_second = 1;
  scene.materials.push_back(Material{});
  scene.materials.back().name = "snow";
  return scene;
}

bool finite(const Particles& p) {
  for (std::size_t at = 0; at < p.size(); ++at)
    if (!p.x[at].allFinite() || !p.v[at].allFinite() || !p.F_E[at].allFinite() ||
        !p.F_P[at].allFinite())
      return false;
  return true;
}

Vec3 momentum(const Particles& p) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t at = 0; at < p.size(); ++at) sum += p.m[at] * p.v[at];
  return sum;
}

/// What a solver did, in words, and how well it kept the momentum.
struct Outcome {
  std::string text;
  bool stopped = false, silent = false;
  double momentum_error = 0;  ///< |Σmv − Σmv(0)| / Σ m max|v|
};

Outcome run(const Registry& registry, const Subject& subject, const Situation& situation) {
  Scene scene = plain_scene();
  State state;
  situation.change(scene, state.particles);
  const Vec3 before = momentum(state.particles);
  Outcome outcome;
  double mass = 0, fastest = 0;
  for (const double m : state.particles.m) mass += m;
  try {
    const auto solver = subject.create(registry);
    solver->load(scene, state);
    for (int step = 0; step < steps; ++step) {
      solver->step(scene.time.step);
      solver->store(state);
      for (const Vec3& v : state.particles.v) fastest = std::max(fastest, v.norm());
      if (finite(state.particles)) continue;
      outcome.silent = true;
      outcome.text = "went on with numbers that are not finite from step " + std::to_string(step);
      return outcome;
    }
  } catch (const std::exception& error) {
    outcome.stopped = true;
    outcome.text = std::string("stopped: ") + error.what();
    return outcome;
  }
  outcome.text = std::to_string(steps) + " steps, all finite";
  if (mass * fastest > 0)
    outcome.momentum_error = (momentum(state.particles) - before).norm() / (mass * fastest);
  return outcome;
}

void measure(const Registry& registry, const Subject& subject, const Situation& situation,
             results::Case& result) {
  const Outcome outcome = run(registry, subject, situation);
  result.parameters.emplace_back("outcome", outcome.text);
  result.validation = outcome.text;
  const bool stops = situation.expected == Expected::stops;
  // A few hundred roundings a step at most: 64 nodes, up to 100 particles.
  const double eps = subject.precision == Precision::float32 ? 0x1p-23 : 0x1p-52;
  const double allowed = steps * 200 * eps;
  if (outcome.silent || outcome.stopped != stops)
    result.message = outcome.text;
  else if (!stops && !(outcome.momentum_error <= allowed))
    result.message =
        "momentum off by " + to_text(outcome.momentum_error) + ", allowed " + to_text(allowed);
  if (!result.message.empty()) {
    result.status = results::Status::invalid;
    return;
  }
  if (!stops)
    result.quantities = {{"momentum",
                          "1",
                          "change of Σ m v over 20 steps, over Σ m max|v|",
                          Quantity::Better::neither,
                          {outcome.momentum_error},
                          false}};
}

}  // namespace

void plan_stress_suite(const Registry& registry, const Options& options,
                       std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false))
    for (const Situation& situation : situations) {
      CasePlan plan;
      results::Case& d = plan.description;
      d.suite = "stress";
      d.name = std::string(situation.name) + "," + subject.text();
      d.title = d.name;
      d.parameters = {
          {"situation", std::string(situation.name)},
          {"expected", std::string(situation.expected == Expected::stops ? "stops" : "goes on")}};
      subject.describe(d);
      plan.quick = true;
      plan.run = [&registry, subject, situation](results::Case& result) {
        measure(registry, subject, situation, result);
      };
      plans.push_back(std::move(plan));
    }
}

}  // namespace firn::bench
