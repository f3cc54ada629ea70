// SPDX-License-Identifier: BSD-3-Clause
/// The largest stable step, beside the predicted one.

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "verification/studies/stability.hpp"
#include "verification/suite/probes.hpp"

namespace firn::suite {
namespace {

using studies::StabilityPoint;

/// In the middle of a cell, the seed of the perturbation 71.
StabilityPoint point_of(double alpha = 0.95, double J_P = 1) {
  StabilityPoint point;
  point.alpha = alpha;
  point.J_P = J_P;
  point.h = spacing;
  point.place = 0.5;
  point.seed = 71;
  return point;
}

StabilityPoint lone_point() {
  StabilityPoint point = point_of();
  point.lone = true;
  point.per_edge = 1;
  return point;
}

/// Stable 3 % below the prediction, unstable 3 % above.
void within_three_percent(const std::string& what, const StabilityPoint& point) {
  const double limit = studies::predicted_cfl(point);
  const auto stable = [&](double cfl) { return studies::stable(study_subject(), point, cfl); };
  expect(fmt::format("{}: stable at {:.3f}", what, 0.97 * limit), stable(0.97 * limit));
  expect(fmt::format("{}: unstable at {:.3f}", what, 1.03 * limit), !stable(1.03 * limit));
}

FIRN_TEST(Stability, bulk_limit) {
  FIRN_NEEDS_SPEED();
  within_three_percent("alpha 0.95", point_of());
}

FIRN_TEST(Stability, lone_particle) {
  FIRN_NEEDS_SPEED();
  within_three_percent("lone particle", lone_point());
}

/// Δt = min(max_step, cfl h/max‖v‖, elastic_cfl h/max c_p), c_p with the hardened moduli and
/// ρ_p = m_p/V_p0.
FIRN_TEST(Stability, choice_of_the_time_step) {
  Scene scene = plain_scene();
  scene.materials[0].hardening = 10;
  scene.time.adaptive = true;
  scene.time.max_step = 0x1p-6;
  scene.time.cfl = 0.5;
  scene.time.elastic_cfl = 0.25;
  State state;
  Particles& p = state.particles;
  p.resize(5);
  for (std::size_t q = 0; q < p.size(); ++q) {
    p.x[q] = spacing * Vec3(static_cast<double>(q), 0.5, 0.5);
    p.V_0[q] = 0x1p-12;
    p.m[q] = 400 * p.V_0[q];
    p.id[q] = static_cast<std::int64_t>(q);
  }
  const auto chosen = [&] {
    const auto solver = make_subject();
    solver->load(scene, state);
    return solver->choose_time_step().dt;
  };
  const Material& m = scene.materials[0];
  const double c = std::sqrt((m.lambda_0() + 2 * m.mu_0()) / 400);
  // Sums, products, a root and an exponential: some 64 roundings, those of ξ J_P included.
  const auto is = [&](const char* what, double dt) {
    within(what, chosen() - dt, 128 * eps() * dt);
  };
  is("elastic limit", 0.25 * spacing / c);
  p.F_P[2] = Vec3(0.875, 1, 1).asDiagonal();
  is("elastic limit of hardened snow", 0.25 * spacing / (c * std::exp(0.5 * 10 * 0.125)));
  p.m[3] /= 16;
  is("elastic limit of light snow", 0.25 * spacing / (4 * c));
  p.v[4] = Vec3(0, 3000, 4000);
  is("cfl limit", 0.5 * spacing / 5000);
  scene.time.max_step = 0x1p-20;
  is("largest step", 0x1p-20);
  scene.time.adaptive = false;
  scene.time.step = 0x1p-9;
  is("fixed step", 0x1p-9);
}

/// The limit by bisection, noted for the map.
double measured(const StabilityPoint& point, const char* varied, double value) {
  const double cfl = studies::largest_stable(study_subject(), point).cfl;
  Observation o;
  o.suite = "stability";
  o.name = fmt::format("{}={}", varied, value);
  o.title = "largest stable step, " + o.name;
  o.parameters = {{"varied", std::string(varied)},
                  {"value", value},
                  {"alpha", point.alpha},
                  {"E", point.E},
                  {"h", point.h},
                  {"J_P", point.J_P},
                  {"particles_per_cell", std::pow(point.per_edge, 3)},
                  {"jitter", point.jitter}};
  o.quantities = {{"cfl", "1", "largest stable cΔt/h, hardened c", cfl},
                  {"step", "s", "largest stable Δt", cfl * point.unit_step()},
                  {"predicted_cfl", "1", "predicted cΔt/h", studies::predicted_cfl(point)}};
  observe(std::move(o));
  return cfl;
}

FIRN_TEST(Stability, long_limits) {
  FIRN_NEEDS_SPEED();
  const auto near = [](const char* varied, double value, const StabilityPoint& point) {
    const double cfl = measured(point, varied, value), limit = studies::predicted_cfl(point);
    within(fmt::format("{} {}: 3 % of the prediction", varied, value), cfl / limit - 1, 0.03,
           fmt::format("{:.3f} where {:.3f} is predicted", cfl, limit));
  };
  for (const double alpha : {0.0, 0.5, 0.8, 0.95, 1.0}) near("alpha", alpha, point_of(alpha));
  for (const double J_P : {0.5, 0.7, 0.9}) near("J_P", J_P, point_of(0.95, J_P));
  near("lone particle", 1, lone_point());
}

}  // namespace
}  // namespace firn::suite
