/// The largest stable step, beside the predicted one.

#include <Eigen/LU>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "firn/error.hpp"
#include "verification/suite/probes.hpp"

namespace firn::suite {
namespace {

/// A periodic block of 8×4×4 cells or a lone particle, F perturbed: a particle carries no velocity
/// gradient, so perturbed velocities would show nothing.
struct Point {
  double alpha = 0.95, J_P = 1;
  int per_edge = 2;
  bool lone = false, estimated = false;
};

/// Far above the roundoff of F, far below what is not linear.
double perturbation() { return in_float() ? 1e-4 : 1e-7; }
/// Growth by this factor is an instability.
double blown_up() { return in_float() ? 1e2 : 1e4; }

double sound_speed(const Point& point) {
  const Material m = elastic_material();
  return std::sqrt(std::exp(10 * (1 - point.J_P)) * (m.lambda_0() + 2 * m.mu_0()) / m.density);
}

/// c Δt/h. The bulk limit is where a root of a² − tr a + det leaves the unit circle for some wave
/// number: 1.572, 1.498, 1.496 at α = 0, 0.95, 1. A lone particle in the middle of a cell:
/// Δt = √2 h √(m/(S V (2μ + 3λ))) with S = ΣN'²/N = 3.137, CFL 0.653.
double predicted(const Point& point) {
  const Material m = elastic_material();
  if (point.lone)
    return std::sqrt(2 * (m.lambda_0() + 2 * m.mu_0()) /
                     (3.137 * (2 * m.mu_0() + 3 * m.lambda_0())));
  double limit = 10;
  for (double kh = 0.5; kh < 3.1; kh += 0.005) {
    const double half = 0.5 * kh, N_hat = std::pow(std::sin(half) / half, 4), N2 = N_hat * N_hat;
    double low = 0, high = 10;
    for (int i = 0; i < 50; ++i) {
      const double cfl = 0.5 * (low + high), z2 = std::pow(kh * N_hat * cfl, 2);
      const double det = point.alpha * (1 - N2) * (1 - z2) + N2,
                   tr = point.alpha * (1 - N2) + N2 + 1 - z2;
      // Jury's conditions; det = 1 at α = 1 is marginal by design.
      (std::abs(det) <= 1 + 1e-12 && std::abs(tr) <= 1 + det + 1e-12 ? low : high) = cfl;
    }
    limit = std::min(limit, low);
  }
  return limit;
}

bool stable(const Point& point, double cfl) {
  Scene scene = plain_scene();
  scene.flip = point.alpha;
  scene.materials[0].hardening = 10;
  if (!point.lone) scene.grid.periodic = spacing * Vec3(8, 4, 4);
  fixtures::Random random(71);
  State state;
  Particles& p = state.particles;
  const int n = point.per_edge;
  const double h = spacing, V = h * h * h / (n * n * n);
  std::vector<Vec3> x;
  for (int i = 0; i < (point.lone ? 1 : 8 * n); ++i)
    for (int j = 0; j < (point.lone ? 1 : 4 * n); ++j)
      for (int k = 0; k < (point.lone ? 1 : 4 * n); ++k) {
        Vec3 at = h / n * Vec3(i + 0.5, j + 0.5, k + 0.5);
        if (point.estimated) at += 0.4 * h / n * random.vec3();
        x.push_back(rounded(at));
      }
  p.resize(x.size());
  p.x = x;
  for (std::size_t q = 0; q < x.size(); ++q) {
    p.m[q] = 400 * V;
    if (!point.estimated) p.V_0[q] = V;
    p.id[q] = static_cast<std::int64_t>(q);
    p.F_P[q] = std::cbrt(point.J_P) * Mat3::Identity();
    p.F_E[q] += perturbation() * random.mat3();
  }
  if (point.lone) p.x[0] = h * Vec3(0.5, 0.5, 0.5);
  const double dt = cfl * h / sound_speed(point);
  const auto solver = make_subject();
  try {
    solver->load(scene, state);
    for (int step = 1; step <= 600; ++step) {
      solver->step(dt);
      if (step % 50 != 0) continue;
      solver->store(state);
      for (const Mat3& F : p.F_E)
        if (!((F - Mat3::Identity()).norm() < blown_up() * perturbation())) return false;
    }
  } catch (const SimulationError&) {
    return false;
  }
  return true;
}

#define FIRN_NEEDS_SPEED() \
  if (subject().slow) GTEST_SKIP() << "every step starts a program: too long"

/// Stable 3 % below the prediction, unstable 3 % above.
void within_three_percent(const std::string& what, const Point& point) {
  const double limit = predicted(point);
  expect(fmt::format("{}: stable at {:.3f}", what, 0.97 * limit), stable(point, 0.97 * limit));
  expect(fmt::format("{}: unstable at {:.3f}", what, 1.03 * limit), !stable(point, 1.03 * limit));
}

TEST(Stability, bulk_limit) {
  FIRN_NEEDS_SPEED();
  within_three_percent("alpha 0.95", {});
}

TEST(Stability, lone_particle) {
  FIRN_NEEDS_SPEED();
  Point lone;
  lone.lone = true;
  lone.per_edge = 1;
  within_three_percent("lone particle", lone);
}

/// Δt = min(max_step, cfl h/max‖v‖, elastic_cfl h/max c_p), c_p with the hardened moduli and
/// ρ_p = m_p/V_p0.
TEST(Stability, choice_of_the_time_step) {
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

/// The limit by bisection to half a per cent, noted for the map.
double measured(const Point& point, const char* varied, double value) {
  double low = 0.05, high = 3;
  if (!stable(point, low)) return 0;
  for (int i = 0; i < 9; ++i) {
    const double middle = 0.5 * (low + high);
    (stable(point, middle) ? low : high) = middle;
  }
  const double cfl = 0.5 * (low + high);
  Observation o;
  o.suite = "stability";
  o.name = fmt::format("{}={}", varied, value);
  o.title = "largest stable step, " + o.name;
  o.parameters = {{"varied", std::string(varied)},
                  {"value", value},
                  {"alpha", point.alpha},
                  {"E", elastic_material().youngs_modulus},
                  {"h", spacing},
                  {"J_P", point.J_P},
                  {"particles_per_cell", std::pow(point.per_edge, 3)},
                  {"jitter", point.estimated ? 0.8 : 0.0}};
  o.quantities = {{"cfl", "1", "largest stable cΔt/h, hardened c", cfl},
                  {"step", "s", "largest stable Δt", cfl * spacing / sound_speed(point)}};
  if (!point.estimated)
    o.quantities.push_back({"predicted_cfl", "1", "predicted cΔt/h", predicted(point)});
  observe(std::move(o));
  return cfl;
}

TEST(Stability, long_limits) {
  FIRN_NEEDS_SPEED();
  const auto near = [](const char* varied, double value, const Point& point) {
    const double cfl = measured(point, varied, value);
    within(fmt::format("{} {}: 3 % of the prediction", varied, value), cfl / predicted(point) - 1,
           0.03, fmt::format("{:.3f} where {:.3f} is predicted", cfl, predicted(point)));
  };
  for (const double alpha : {0.0, 0.5, 0.8, 0.95, 1.0}) {
    Point point;
    point.alpha = alpha;
    near("alpha", alpha, point);
  }
  for (const double J_P : {0.5, 0.7, 0.9}) {
    Point point;
    point.J_P = J_P;
    near("J_P", J_P, point);
  }
  Point lone;
  lone.lone = true;
  lone.per_edge = 1;
  near("lone particle", 1, lone);
}

}  // namespace
}  // namespace firn::suite
