// SPDX-License-Identifier: BSD-3-Clause
/// What float costs in accuracy: creeping motion, small strain rates, distance from
/// the origin, drift against double over a long run.

#include <cmath>
#include <stdexcept>
#include <utility>

#include "bench/study.hpp"
#include "bench/suites.hpp"
#include "bench/workload.hpp"
#include "verification/studies/float_drift.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

/// One number that is 0 in exact arithmetic.
struct Test {
  const char *name, *title, *meaning;
  double (*measure)(const studies::Subject&, std::uint64_t seed);
};

/// 512 undeformed particles around x = 1 m, moving at 1 mm/s with Δt = 10 µs: 1e-8 m a
/// step, below the resolution of a float at 1. How far did they get?
double creep(const studies::Subject& subject, std::uint64_t seed) {
  Workload work = block(512, Deformation::elastic, seed);
  work.scene.time.step = 1e-5;
  for (Vec3& x : work.state.particles.x) x += Vec3::Ones();
  return std::abs(
      studies::creep(subject, work.scene, work.state, Vec3(1e-3, 0, 0), 1000, 1e-5).x());
}

/// Stretching at 1e-3 /s with Δt = 10 µs: 1e-8 a step, less than float's eps at F = 1.
/// Nearly without stiffness, so that only the kinematics count.
double small_strain(const studies::Subject& subject, std::uint64_t seed) {
  Scene scene = block(8, Deformation::elastic, seed).scene;
  scene.time.step = 1e-5;
  scene.flip = 1;
  scene.materials.front().youngs_modulus = 1e-6;
  // On a lattice the grid holds the linear field exactly, 2 cells and more from the surface: nodes
  // of the particles within 2 h of the middle reach 2 h further, and those nodes' particles
  // another 2 h.
  studies::Stretch stretch;
  stretch.half_width = 2 * scene.grid.spacing;
  return studies::small_strain(subject, scene, stretch);
}

/// The same block at the origin and 10⁴ spacings away.
double far_away(const studies::Subject& subject, std::uint64_t seed) {
  const Workload work = block(4096, Deformation::plastic, seed);
  return studies::far_away(subject, work.scene, work.state, 640.0);
}

/// An elastic block that rings at its own sound speed.
std::vector<std::pair<int, double>> drift(const Registry& registry, const Subject& subject,
                                          std::uint64_t seed) {
  Workload work = block(2048, Deformation::elastic, seed);
  work.scene.time.step = 2e-4;
  Particles& p = work.state.particles;
  for (std::size_t at = 0; at < p.size(); ++at)
    p.v[at] = Vec3(0.05 * std::sin(8 * p.x[at].x()), 0, 0);
  const auto reference = registry.create(reference_name, {});
  return studies::drift(study_subject(registry, subject), *reference, work.scene, work.state);
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
        const double error = test.measure(study_subject(registry, subject), seed);
        if (!std::isfinite(error)) throw std::runtime_error("the result is not finite");
        result.quantities = {{"error", "1", test.meaning, Quantity::Better::lower, {error}, false}};
        result.validation = "the exact value is known";
      };
      plans.push_back(std::move(plan));
    }
  for (const Subject& subject : subjects(registry, options, false))
    if (subject.solver != reference_name && registry.find(reference_name) != nullptr)
      plan_drift(registry, options, subject, plans);
}

}  // namespace firn::bench
