// SPDX-License-Identifier: BSD-3-Clause
/// Motions with exact discrete or closed solutions.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "firn/diagnostics.hpp"
#include "verification/studies/convergence.hpp"
#include "verification/studies/stability.hpp"
#include "verification/suite/probes.hpp"

namespace firn::suite {
namespace {

/// A plane wave u = A a(t) sin(kX) d along x on a periodic lattice; studies::wave_recurrence.
struct Wave {
  int axis;  ///< of the motion: 0 P, 1 and 2 the two S
  double alpha, beta, cfl;
  std::string text() const {
    static constexpr const char* names[] = {"P", "S_y", "S_z"};
    return fmt::format("{}, alpha {}, beta {}, CFL {}", names[axis], alpha, beta, cfl);
  }
};

void plane_wave(const Wave& wave) {
  if (wave.beta > 0 && !solves_implicitly()) return;
  constexpr int nodes = 16;
  Scene scene = plain_scene();
  const double h = spacing, length = nodes * h, k = 2 * M_PI / length;
  scene.grid.periodic = Vec3(length, 4 * h, 4 * h);
  scene.flip = wave.alpha;
  scene.integrator.type =
      wave.beta > 0 ? IntegratorType::semi_implicit : IntegratorType::explicit_euler;
  scene.integrator.implicitness = wave.beta;
  scene.integrator.tolerance = in_float() ? 1e-6 : 1e-12;
  scene.integrator.max_iterations = 2000;
  const Material& material = scene.materials[0];
  const double modulus =
      wave.axis == 0 ? material.lambda_0() + 2 * material.mu_0() : material.mu_0();
  const double c = std::sqrt(modulus / material.density), dt = wave.cfl * h / c;
  // Strains of A/c are linear to 1e-8 in double, where roundoff is 1e-8 of them, and to 1e-5 in
  // float, where they are above the roundoff of F − I by as much.
  const double A = in_float() ? 0x1p-13 : 0x1p-23;

  State state = fixtures::lattice_block(scene, {nodes, 4, 4});
  Particles& p = state.particles;
  const std::vector<Vec3> X = p.x;
  for (std::size_t q = 0; q < X.size(); ++q) p.v[q][wave.axis] = rounded(A * std::sin(k * X[q][0]));
  const auto amplitude = [&] {
    double sum = 0;
    for (std::size_t q = 0; q < X.size(); ++q) sum += std::sin(k * X[q][0]) * p.v[q][wave.axis];
    return 2 * sum / (static_cast<double>(X.size()) * A);
  };
  const auto solver = make_subject();
  solver->load(scene, state);
  const auto next_amplitude = [&] {
    solver->step(dt);
    solver->store(state);
    return amplitude();
  };
  const auto [det, tr] = studies::wave_recurrence(wave.alpha, wave.beta, k * h, wave.cfl);
  double last = amplitude(), now = next_amplitude();
  for (int n = 0; n < effort(40, 3); ++n) {
    const double expected = tr * now - det * last;
    last = now;
    now = expected;
    // The formula takes Σ_p for an integral: 2 particles per cell edge leave 4e-5.
    within(wave.text(), next_amplitude() - expected, 1e-4);
  }
}

FIRN_TEST(Dynamics, plane_waves) {
  for (const double alpha : {0.0, 0.95, 1.0}) {
    plane_wave({0, alpha, 0, 0.5});
    if (subject().slow) return;
  }
  for (const int axis : {1, 2}) plane_wave({axis, 0.95, 0, 0.5});
  plane_wave({0, 1, 1, 1});
  plane_wave({0, 0.95, 0.5, 1});
  plane_wave({0, 0.5, 0.5, 0.2});
  plane_wave({1, 0.95, 0.5, 1});
  plane_wave({2, 0, 1, 1});
}

FIRN_TEST(Dynamics, long_plane_waves) {
  for (const int axis : {0, 1, 2})
    for (const double alpha : {0.0, 0.5, 0.95, 1.0})
      for (const double beta : {0.0, 0.5, 1.0})
        for (const double cfl : {0.2, 0.5, 1.0}) plane_wave({axis, alpha, beta, cfl});
}

using studies::AlphaPolicy;
using studies::order;
using studies::pic;
using studies::undamped;
using studies::vortex_of_15_percent;

/// Runs it and notes error and time for the plots.
double error_of(studies::MakeProblem make, int cells, double cfl, const AlphaPolicy& policy) {
  const studies::ExactProblem problem = make(cells, cfl, policy);
  const auto [error, seconds] = studies::run_exact(study_subject(), *make_subject(), problem);
  Observation o;
  o.suite = "accuracy";
  o.name = fmt::format("{},n={},cfl={},alpha={}", problem.name, cells, cfl, policy.name);
  o.title = o.name;
  o.parameters = {{"problem", problem.name},
                  {"cells", static_cast<double>(cells)},
                  {"h", problem.scene.grid.spacing},
                  {"cfl", cfl},
                  {"alpha_policy", policy.name},
                  {"alpha", problem.scene.flip},
                  {"particles", static_cast<double>(problem.X.size())},
                  {"steps", static_cast<double>(problem.steps)}};
  o.quantities = {{"error", "1", "‖u_h − u‖/‖u‖ over the particles at the end", error},
                  {"time", "s", "wall time of the steps", seconds}};
  observe(std::move(o));
  return error;
}

void at_least(const std::string& what, double order, double least) {
  within(fmt::format("{}: order at least {}", what, least), std::max(0.0, least - order), 1e-12,
         fmt::format("order {:.3f}", order));
}

void between(const std::string& what, double order, double low, double high) {
  within(fmt::format("{}: order {} to {}", what, low, high), order - 0.5 * (low + high),
         0.5 * (high - low), fmt::format("order {:.3f}", order));
}

FIRN_TEST(Dynamics, standing_wave) {
  FIRN_NEEDS_SPEED();
  const double e16 = error_of(exact::standing_wave, 16, 0.4, undamped),
               e32 = error_of(exact::standing_wave, 32, 0.4, undamped);
  at_least("alpha = 1, 16 to 32 cells", order(e16, e32), 1.9);
}

FIRN_TEST(Dynamics, manufactured_solution) {
  FIRN_NEEDS_SPEED();
  const double e8 = error_of(exact::manufactured, 8, 0.4, undamped),
               e16 = error_of(exact::manufactured, 16, 0.4, undamped);
  at_least("alpha = 1, 8 to 16 cells", order(e8, e16), 1.8);
}

FIRN_TEST(Dynamics, column) {
  FIRN_NEEDS_SPEED();
  const double e8 = error_of(exact::column, 8, 0.4, pic),
               e16 = error_of(exact::column, 16, 0.4, pic);
  // 8 cells are few: the finest pair of the long study keeps 0.95 to 1.05.
  between("alpha = 0, 8 to 16 cells", order(e8, e16), 0.85, 1.15);
}

FIRN_TEST(Dynamics, long_standing_wave) {
  FIRN_NEEDS_SPEED();
  double last = 0;
  for (const int cells : {16, 32, 64, 128}) {
    const double error = error_of(exact::standing_wave, cells, 0.4, undamped);
    if (last > 0) at_least(fmt::format("alpha = 1, to {} cells", cells), order(last, error), 1.9);
    last = error;
  }
  last = 0;
  for (const int cells : {32, 64, 128, 256}) {
    const double error = error_of(exact::standing_wave, cells, 0.5, pic);
    // The damping 1 − e^{−a h} saturates where a h is not small.
    if (cells == 256) between("alpha = 0, 128 to 256 cells", order(last, error), 0.9, 1.1);
    last = error;
  }
}

FIRN_TEST(Dynamics, long_manufactured_solution) {
  FIRN_NEEDS_SPEED();
  double last = 0;
  for (const int cells : {8, 16, 32}) {
    const double error = error_of(exact::manufactured, cells, 0.4, undamped);
    if (last > 0) at_least(fmt::format("alpha = 1, to {} cells", cells), order(last, error), 1.8);
    last = error;
  }
}

FIRN_TEST(Dynamics, long_column) {
  FIRN_NEEDS_SPEED();
  double last = 0;
  for (const int cells : {8, 16, 32}) {
    const double error = error_of(exact::column, cells, 0.4, pic);
    if (cells == 32) between("alpha = 0, 16 to 32 cells", order(last, error), 0.95, 1.05);
    last = error;
  }
}

FIRN_TEST(Dynamics, long_vortex) {
  FIRN_NEEDS_SPEED();
  const double e32 = error_of(vortex_of_15_percent, 32, 0.4, undamped);
  error_of(vortex_of_15_percent, 64, 0.4, undamped);
  const double e128 = error_of(vortex_of_15_percent, 128, 0.4, undamped);
  within("e(128)/e(32)", e128 / e32, 0.35, fmt::format("{:.4f} and {:.4f}", e32, e128));
}

/// Two elastic blocks meet head-on: momentum stays, energy never grows, and they part again.
FIRN_TEST(Dynamics, two_elastic_bodies) {
  FIRN_NEEDS_SPEED();
  Scene scene = plain_scene();
  scene.flip = 0.95;
  const double h = spacing, speed = 0.5, c = 20;
  State state;
  Particles& p = state.particles;
  std::vector<Vec3> x, v;
  for (const double side : {-1.0, 1.0})
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 8; ++j)
        for (int k = 0; k < 8; ++k) {
          // A gap of two and a half cells: no node feels both.
          x.push_back(
              Vec3(side * h * (1.75 + 0.5 * (i + 0.5)), 0.5 * h * (j + 0.5), 0.5 * h * (k + 0.5)));
          v.push_back(Vec3(-side * speed, 0, 0));
        }
  p.resize(x.size());
  p.x = x;
  p.v = v;
  for (std::size_t q = 0; q < x.size(); ++q) {
    p.V_0[q] = h * h * h / 8;
    p.m[q] = 400 * p.V_0[q];
    p.id[q] = static_cast<std::int64_t>(q);
  }
  const Totals before = totals(p);
  const double dt = rounded(0.3 * h / c);
  const auto solver = make_subject();
  solver->load(scene, state);
  const auto relative_speed = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t q = 0; q < p.size(); ++q)
      sum += (q < p.size() / 2 ? -1.0 : 1.0) * p.m[q] * p.v[q];
    return 2 * sum[0] / before.mass;
  };
  double smallest = relative_speed(), largest = smallest;
  for (int n = 0; n < 600; ++n) {
    solver->step(dt);
    if (n % 20 != 19) continue;
    solver->store(state);
    const Totals now = totals(p);
    within("momentum", (now.momentum - before.momentum).norm(),
           450 * eps() * before.momentum_scale);
    const double energy = measure(scene, state).elastic_energy + now.kinetic_energy;
    within("energy above the initial", std::max(0.0, energy - before.kinetic_energy),
           450 * eps() * before.kinetic_energy);
    smallest = std::min(smallest, relative_speed());
    largest = std::max(largest, relative_speed());
  }
  within("approach as they started", smallest + 2 * speed, 1e-3 * speed);
  const double restitution = largest / (2 * speed);
  expect("they part again, not faster than they met", restitution > 0.2 && restitution <= 1,
         fmt::format("restitution {:.3f}", restitution));
}

}  // namespace
}  // namespace firn::suite
