// SPDX-License-Identifier: BSD-3-Clause
#include "verification/studies/stability.hpp"

#include <cmath>

#include "firn/error.hpp"
#include "verification/support/random.hpp"
#include "verification/support/scenes.hpp"

namespace firn::studies {

namespace {

Scene scene_of(const StabilityPoint& point, double dt) {
  Scene scene = fixtures::elastic_scene("stability", point.h, dt);
  // Eight spacings hold the most critical wave, 3.7 h, nearly twice.
  if (!point.lone) scene.grid.periodic = point.h * Vec3(8, 4, 4);
  scene.flip = point.alpha;
  scene.materials[0].youngs_modulus = point.E;
  scene.materials[0].hardening = point.hardening;
  if (point.semi_implicit()) {
    scene.integrator.type = IntegratorType::semi_implicit;
    scene.integrator.implicitness = point.beta;
    scene.integrator.tolerance = 1e-6;
    scene.integrator.max_iterations = 1000;
  }
  return scene;
}

State state_of(const StabilityPoint& point, const Scene& scene, double perturbation) {
  fixtures::Random random(point.seed);
  State state;
  Particles& p = state.particles;
  const int n = point.per_edge;
  const double h = point.h, V = h * h * h / (n * n * n);
  const Vec3 cells = point.lone ? Vec3(1.0 / n, 1.0 / n, 1.0 / n) : Vec3(8, 4, 4);
  std::vector<Vec3> places;
  for (int i = 0; i < std::lround(cells[0] * n); ++i)
    for (int j = 0; j < std::lround(cells[1] * n); ++j)
      for (int k = 0; k < std::lround(cells[2] * n); ++k) {
        Vec3 x = point.lone ? Vec3(Vec3::Constant(point.place * h))
                            : Vec3(h / n * Vec3(i + 0.5, j + 0.5, k + 0.5));
        for (int axis = 0; axis < 3; ++axis) x[axis] += 0.5 * point.jitter * h / n * random();
        places.push_back(scene.wrap(x));
      }
  p.resize(places.size());
  p.x = places;
  for (std::size_t at = 0; at < p.size(); ++at) {
    p.V_0[at] = point.estimated ? 0 : V;
    p.m[at] = 400 * V;
    p.id[at] = static_cast<std::int64_t>(at);
    p.F_P[at] = std::cbrt(point.J_P) * Mat3::Identity();
    p.F_E[at] += perturbation * random.mat3();
  }
  return state;
}

}  // namespace

double perturbation(Precision precision) { return precision == Precision::float32 ? 1e-4 : 1e-7; }
double burst_growth(Precision precision) { return precision == Precision::float32 ? 1e2 : 1e4; }

namespace {

/// False: F has grown beyond `most`. Looks after every `interval` steps.
bool stays_below(double most, const Subject& subject, const Scene& scene, const State& initial,
                 double dt, int interval) {
  const auto solver = subject.create();
  solver->load(scene, initial);
  State state;
  for (int step = 1; step <= stability_steps; ++step) {
    subject.step(*solver, dt);
    if (step % interval != 0) continue;
    solver->store(state);
    for (const Mat3& F : state.particles.F_E)
      if (!((F - Mat3::Identity()).norm() < most)) return false;
  }
  return true;
}

}  // namespace

bool stable(const Subject& subject, const StabilityPoint& point, double cfl) {
  const double dt = cfl * point.unit_step(), start = perturbation(subject.precision);
  const double most = burst_growth(subject.precision) * start;
  const Scene scene = scene_of(point, dt);
  const State initial = state_of(point, scene, start);
  try {
    return stays_below(most, subject, scene, initial, dt, 50);
  } catch (const SimulationError&) {
    // A solve that does not converge is where such steps end.
    if (point.semi_implicit()) return false;
  }
  // An explicit step fails because F has burst, or for a reason of the solver's own, which says
  // nothing about stability: then F is as small as ever right before, and the error goes on.
  return stays_below(most, subject, scene, initial, dt, 1);
}

StabilityLimit largest_stable(const Subject& subject, const StabilityPoint& point) {
  StabilityLimit limit;
  const auto holds = [&](double cfl) {
    const bool yes = stable(subject, point, cfl);
    (yes ? limit.held : limit.burst).push_back(cfl);
    return yes;
  };
  double low = 0.05, high = point.semi_implicit() ? largest_tried : 3.0;
  if (!holds(low)) {
    limit.none = true;
    high = low, low = 0;
  }
  limit.unlimited = point.semi_implicit() && holds(high);
  if (limit.unlimited) low = high;
  // 3 / 2^9: half a per cent of a limit near 1.5; then on to 1 % of smaller limits.
  for (int i = 0; i < 9 || high - low > 0.01 * high; ++i) {
    if (limit.unlimited || i == 14) break;
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  limit.cfl = 0.5 * (low + high);
  return limit;
}

}  // namespace firn::studies
