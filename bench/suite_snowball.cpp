/// The plastic snowball has no formal order of convergence: bands over seeds, never an order.

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include "bench/suites.hpp"
#include "bench/timing.hpp"
#include "firn/error.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

/// A ball of 0.3 m, just above the ground, falling at 3 m/s; h = 0.3 m / resolution.
Scene snowball(int resolution, std::uint64_t seed) {
  Scene scene;
  scene.name = "snowball over seeds";
  scene.gravity = Vec3(0, 0, -9.81);
  scene.grid.spacing = 0.3 / resolution;
  // A fifth of the elastic limit of the undeformed snow: compacted snow is stiffer.
  Material snow;
  snow.name = "snow";
  const double c = std::sqrt((snow.lambda_0() + 2 * snow.mu_0()) / snow.density);
  scene.time.step = 0.2 * scene.grid.spacing / c;
  scene.time.end = 0.15;
  scene.time.frames_per_second = 1;
  scene.materials.push_back(snow);
  Body ball;
  ball.shape = Sphere{Vec3(0, 0, 0.4), 0.3};
  ball.seed = seed;
  ball.velocity = Vec3(0, 0, -3);
  ball.volumes = VolumeSource::exact;
  scene.bodies.push_back(ball);
  Collider ground;
  ground.shape = HalfSpace{Vec3(0, 0, -1e-3 * scene.grid.spacing), Vec3::UnitZ()};
  ground.friction = 0.3;
  scene.colliders.push_back(ground);
  return scene;
}

/// Mass on a coarse grid, by cell.
using CoarseMass = std::map<std::array<int, 3>, double>;

struct Outcome {
  double center = 0, width = 0, J_P = 0, contact = 0;
  CoarseMass mass;
};

/// Cells of 0.1 m, the same for every resolution.
std::array<int, 3> coarse_cell(const Vec3& x) {
  return {static_cast<int>(std::floor(x.x() / 0.1)), static_cast<int>(std::floor(x.y() / 0.1)),
          static_cast<int>(std::floor(x.z() / 0.1))};
}

/// ½ Σ |m − m̄| / Σ m̄ of every outcome, m̄ the mean over all of them: the share of the
/// mass that lies elsewhere than in the mean.
std::vector<double> misplaced(const std::vector<Outcome>& outcomes) {
  CoarseMass mean;
  double total = 0;
  for (const Outcome& o : outcomes)
    for (const auto& [cell, m] : o.mass) {
      mean[cell] += m / static_cast<double>(outcomes.size());
      total += m / static_cast<double>(outcomes.size());
    }
  std::vector<double> shares;
  for (const Outcome& o : outcomes) {
    double off = 0;
    for (const auto& [cell, m] : mean) {
      const auto at = o.mass.find(cell);
      off += std::abs((at == o.mass.end() ? 0 : at->second) - m);
    }
    shares.push_back(0.5 * off / total);
  }
  return shares;
}

Outcome simulate(const Registry& registry, const Subject& subject, const Scene& scene) {
  State state = initial_state(scene);
  const auto solver = subject.create(registry);
  solver->load(scene, state);
  Outcome outcome;
  const int steps = static_cast<int>(std::ceil(scene.time.end / scene.time.step));
  const double undisturbed = -3.0;
  for (int step = 1; step <= steps; ++step) {
    if (interrupted()) throw Interrupted{};
    solver->step(scene.time.step);
    if (outcome.contact > 0 || step % 5 != 0) continue;
    // Contact: the momentum has left the law of free fall by 1 %.
    const Diagnostics d = solver->diagnostics(scene);
    const double t = step * scene.time.step, free = undisturbed - 9.81 * t;
    if (d.momentum.z() / d.mass > free + 0.01 * std::abs(free)) outcome.contact = t;
  }
  solver->store(state);
  const Particles& p = state.particles;
  double mass = 0, low = 1e9, high = -1e9;
  for (std::size_t at = 0; at < p.size(); ++at) {
    mass += p.m[at];
    outcome.mass[coarse_cell(p.x[at])] += p.m[at];
    outcome.center += p.m[at] * p.x[at].z();
    outcome.J_P += p.m[at] * p.F_P[at].determinant();
    low = std::min(low, p.x[at].x());
    high = std::max(high, p.x[at].x());
  }
  outcome.center /= mass;
  outcome.J_P /= mass;
  outcome.width = high - low;
  return outcome;
}

}  // namespace

void plan_snowball_suite(const Registry& registry, const Options& options,
                         std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false))
    for (const int resolution : {4, 6, 9}) {
      if (subject.slow() && resolution > 4) continue;
      CasePlan plan;
      plan.description.suite = "snowball";
      plan.description.name = subject.text() + ",resolution=" + std::to_string(resolution);
      plan.description.title = "bands over seeds, " + plan.description.name;
      subject.describe(plan.description);
      plan.description.parameters.emplace_back("resolution", static_cast<double>(resolution));
      plan.quick = !subject.slow() && resolution <= 4;
      plan.run = [=, &registry, seed = options.seed](results::Case& result) {
        Quantity center{
            "center", "m",  "height of the centre of mass at 0.15 s", Quantity::Better::neither,
            {},       false};
        Quantity width{"width", "m",  "extent along x at 0.15 s", Quantity::Better::neither,
                       {},      false};
        Quantity J_P{"J_P", "1",  "mean det F_P, by mass, at 0.15 s", Quantity::Better::neither,
                     {},    false};
        Quantity contact{
            "contact", "s",  "when the momentum leaves free fall by 1 %", Quantity::Better::neither,
            {},        false};
        std::vector<Outcome> outcomes;
        for (std::uint64_t i = 0; i < 5; ++i) {
          outcomes.push_back(simulate(registry, subject, snowball(resolution, seed + i)));
          const Outcome& o = outcomes.back();
          center.values.push_back(o.center);
          width.values.push_back(o.width);
          J_P.values.push_back(o.J_P);
          contact.values.push_back(o.contact);
        }
        Quantity mass{"mass",
                      "1",
                      "share of the mass in other cells of 0.1 m than in the mean of the seeds",
                      Quantity::Better::neither,
                      misplaced(outcomes),
                      false};
        result.quantities = {center, width, J_P, contact, mass};
        for (const Quantity& quantity : result.quantities)
          for (const double value : quantity.values)
            if (!std::isfinite(value)) throw std::runtime_error(quantity.name + " is not finite");
        result.validation = "values of five seeds, no repetitions";
      };
      plans.push_back(std::move(plan));
    }
}

}  // namespace firn::bench
