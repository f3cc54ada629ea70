/// What float costs in accuracy: creeping motion, small strain rates, distance from
/// the origin, drift against double over a long run.

#include <cmath>
#include <stdexcept>
#include <utility>

#include "bench/suites.hpp"
#include "bench/timing.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

/// One number that is 0 in exact arithmetic.
struct Test {
  const char *name, *title, *meaning;
  double (*measure)(const Registry&, const Subject&, std::uint64_t seed);
};

void advance(Solver& solver, const Scene& scene, int steps) {
  for (int i = 0; i < steps; ++i) {
    if (interrupted()) throw Interrupted{};
    solver.step(scene.time.step);
  }
}

/// 512 undeformed particles around x = 1 m, moving at 1 mm/s with Δt = 10 µs: 1e-8 m a
/// step, below the resolution of a float at 1. How far did they get?
double creep(const Registry& registry, const Subject& subject, std::uint64_t seed) {
  Workload work = block(512, Deformation::elastic, seed);
  work.scene.time.step = 1e-5;
  Particles& p = work.state.particles;
  for (std::size_t at = 0; at < p.size(); ++at) {
    p.x[at] += Vec3::Ones();
    p.v[at] = Vec3(1e-3, 0, 0);
    p.F_E[at] = Mat3::Identity();
  }
  const auto solver = subject.create(registry);
  solver->load(work.scene, work.state);
  advance(*solver, work.scene, 1000);
  State state;
  solver->store(state);
  double moved = 0;
  for (std::size_t at = 0; at < p.size(); ++at) moved += state.particles.x[at].x() - p.x[at].x();
  return std::abs(moved / static_cast<double>(p.size()) / 1e-5 - 1);
}

/// Stretching at 1e-3 /s with Δt = 10 µs: 1e-8 a step, less than float's eps at F = 1.
/// Nearly without stiffness, so that only the kinematics count.
double small_strain(const Registry& registry, const Subject& subject, std::uint64_t seed) {
  constexpr int edge = 24;  // particles
  Workload work = block(edge * edge * edge, Deformation::elastic, seed);
  work.scene.time.step = 1e-5;
  work.scene.flip = 1;
  work.scene.materials.front().youngs_modulus = 1e-6;
  Particles& p = work.state.particles;
  // On a lattice the grid holds the linear field exactly, 2 cells and more from the surface.
  const double h = work.scene.grid.spacing, middle = 0.25 * edge * h;
  for (std::size_t at = 0; at < p.size(); ++at) {
    const std::size_t i = at / (edge * edge), j = at / edge % edge, k = at % edge;
    p.x[at] = 0.5 * h *
              Vec3(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5,
                   static_cast<double>(k) + 0.5);
    p.v[at] = Vec3(1e-3 * (p.x[at].x() - middle), 0, 0);
    p.F_E[at] = Mat3::Identity();
  }
  const auto solver = subject.create(registry);
  solver->load(work.scene, work.state);
  constexpr int steps = 200;
  advance(*solver, work.scene, steps);
  State state;
  solver->store(state);
  double strain = 0;
  int count = 0;
  for (std::size_t at = 0; at < p.size(); ++at) {
    // Their nodes reach 2h further, and those nodes' particles another 2h.
    if ((p.x[at] - Vec3::Constant(middle)).cwiseAbs().maxCoeff() > 2 * h) continue;
    strain += state.particles.F_E[at](0, 0) - 1;
    ++count;
  }
  return std::abs(strain / count / (steps * 1e-8) - 1);
}

/// Largest |F_E| difference after 200 steps between a block at the origin and the same
/// block 10⁴ spacings away (a power of two times h, so that the copies are exact).
double far_away(const Registry& registry, const Subject& subject, std::uint64_t seed) {
  State states[2];
  for (const int far : {0, 1}) {
    Workload work = block(4096, Deformation::plastic, seed);
    work.scene.grid.spacing = 0.0625;
    const double scale = 0.0625 / 0.05;
    for (std::size_t at = 0; at < work.state.particles.size(); ++at) {
      Vec3& x = work.state.particles.x[at];
      // Few enough digits that adding the distance rounds nothing away.
      for (int axis = 0; axis < 3; ++axis)
        x[axis] = std::round(scale * x[axis] * 0x1p24) * 0x1p-24 + far * 640.0;
    }
    const auto solver = subject.create(registry);
    solver->load(work.scene, work.state);
    advance(*solver, work.scene, 100);
    solver->store(states[far]);
  }
  double worst = 0;
  for (std::size_t at = 0; at < states[0].particles.size(); ++at)
    worst = std::max(worst, (states[0].particles.F_E[at] - states[1].particles.F_E[at]).norm());
  return worst;
}

/// RMS velocity difference to the reference over the RMS velocity, after 10, 30, … 1000
/// steps of an elastic block that rings at its own sound speed.
std::vector<std::pair<int, double>> drift(const Registry& registry, const Subject& subject,
                                          std::uint64_t seed) {
  Workload work = block(2048, Deformation::elastic, seed);
  work.scene.time.step = 2e-4;
  Particles& p = work.state.particles;
  for (std::size_t at = 0; at < p.size(); ++at)
    p.v[at] = Vec3(0.05 * std::sin(8 * p.x[at].x()), 0, 0);
  const auto reference = registry.create("reference", {}), solver = subject.create(registry);
  reference->load(work.scene, work.state);
  solver->load(work.scene, work.state);
  std::vector<std::pair<int, double>> drifted;
  State mine, theirs;
  int done = 0;
  for (const int steps : {10, 30, 100, 300, 1000}) {
    advance(*reference, work.scene, steps - done);
    advance(*solver, work.scene, steps - done);
    done = steps;
    reference->store(theirs);
    solver->store(mine);
    double off = 0, size = 0;
    for (std::size_t at = 0; at < p.size(); ++at) {
      off += (mine.particles.v[at] - theirs.particles.v[at]).squaredNorm();
      size += theirs.particles.v[at].squaredNorm();
    }
    drifted.emplace_back(steps, std::sqrt(off / size));
  }
  return drifted;
}

constexpr Test tests[] = {
    {"creep", "1e-8 m per step at x = 1 m", "relative error of the distance travelled", creep},
    {"small strain", "strain of 1e-8 per step", "relative error of the accumulated strain",
     small_strain},
    {"far away", "10⁴ spacings from the origin",
     "largest change of F_E against the same block at the origin", far_away},
};

void plan_drift(const Registry& registry, const Options& options, const Subject& subject,
                std::vector<CasePlan>& plans) {
  CasePlan plan;
  plan.description.suite = "float";
  plan.description.name = "drift," + subject.text();
  plan.description.title = "drift of a ringing elastic block, " + subject.text();
  plan.description.parameters = {{"test", std::string("drift")},
                                 {"what", std::string("drift of a ringing elastic block")}};
  subject.describe(plan.description);
  plan.quick = false;
  plan.run = [&registry, subject, seed = options.seed](results::Case& result) {
    const auto drifted = drift(registry, subject, seed);
    const auto quantity = [](const std::string& name, double error) {
      if (!std::isfinite(error)) throw std::runtime_error("the velocities are not finite");
      return Quantity{
          name,    "1",  "RMS velocity off the reference's, relative", Quantity::Better::lower,
          {error}, false};
    };
    result.quantities = {quantity("error", drifted.back().second)};
    for (const auto& [steps, error] : drifted)
      result.quantities.push_back(
          quantity("error after " + std::to_string(steps) + " steps", error));
    result.validation = "against the reference, step for step from the same state";
  };
  plans.push_back(std::move(plan));
}

}  // namespace

void plan_float_suite(const Registry& registry, const Options& options,
                      std::vector<CasePlan>& plans) {
  for (const Test& test : tests)
    for (const Subject& subject : subjects(registry, options, false)) {
      CasePlan plan;
      plan.description.suite = "float";
      plan.description.name = std::string(test.name) + "," + subject.text();
      plan.description.title = std::string(test.title) + ", " + subject.text();
      plan.description.parameters = {{"test", std::string(test.name)},
                                     {"what", std::string(test.title)}};
      subject.describe(plan.description);
      plan.quick = std::string(test.name) != "small strain";  // 10 s, for the same lesson
      plan.run = [&registry, test, subject, seed = options.seed](results::Case& result) {
        const double error = test.measure(registry, subject, seed);
        if (!std::isfinite(error)) throw std::runtime_error("the result is not finite");
        result.quantities = {{"error", "1", test.meaning, Quantity::Better::lower, {error}, false}};
        result.validation = "the exact value is known";
      };
      plans.push_back(std::move(plan));
    }
  for (const Subject& subject : subjects(registry, options, false))
    if (subject.solver != "reference" && registry.find("reference") != nullptr)
      plan_drift(registry, options, subject, plans);
}

}  // namespace firn::bench
