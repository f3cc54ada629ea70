// SPDX-License-Identifier: BSD-3-Clause
/// Ladders of duration: steps, the time at which they begin, iterations of a solve.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "verification/check/implicit_residual.hpp"
#include "verification/suite/copies.hpp"

namespace firn::suite {
namespace {

/// The particle of a free flight, and its closed form after n steps.
struct Flight {
  Scene scene = plain_scene();
  State state;
  static constexpr double dt = 0x1p-10;
  Flight() {
    scene.gravity = Vec3(0, 0x1p-10, -0x1p-9);
    scene.materials[0].youngs_modulus = 1e-9;
    Particles& p = state.particles;
    p.resize(1);
    p.x[0] = spacing * Vec3(0.3125, 0.5, -0.75);
    p.v[0] = Vec3(0.25, -0.125, 0.5);
    p.m[0] = 1;
    p.V_0[0] = 0x1p-12;
  }
  Vec3 v(double n) const { return state.particles.v[0] + n * dt * scene.gravity; }
  Vec3 x(double n) const {
    return state.particles.x[0] + n * dt * state.particles.v[0] +
           scene.gravity * dt * dt * n * (n + 1) / 2;
  }
};

/// 66 000 steps are more than a counter of 16 bits has. Nothing but x and v may change.
FIRN_TEST(Scale, steps_of_free_flight) {
  FIRN_NEEDS_SPEED();
  const Flight flight;
  const auto solver = make_subject();
  solver->load(flight.scene, flight.state);
  State now;
  int n = 0;
  for (const int last : {10, 100, 1000, 10000, 66000}) {
    for (; n < last; ++n) solver->step(Flight::dt);
    solver->store(now);
    const Particles& p = now.particles;
    const std::string after = fmt::format("after {} steps: ", last);
    // Each step rounds v a few times; its error adds up once in v and once more in x.
    const double of_v = 4 * eps() * n * 0.75, T = n * Flight::dt;
    within(after + "v_p", (p.v[0] - flight.v(n)).norm(), of_v);
    within(after + "x_p", (p.x[0] - flight.x(n)).norm(),
           of_v * T + n * 4 * eps() * (4 * spacing + flight.x(n).norm()));
    // Σ|∇w| ≤ 3/h, and v_i is the same at all nodes but for its roundings.
    within(after + "F_E", (p.F_E[0] - Mat3::Identity()).norm(),
           48 * 3 / spacing * 0.75 * eps() * T + 16 * eps());
    within(after + "V_p0", p.V_0[0] - flight.state.particles.V_0[0], 0);
    within(after + "F_P", (p.F_P[0] - Mat3::Identity()).norm(), 64 * eps() * std::sqrt(n));
    expect(after + "number of the step", now.step == n, fmt::format("{}", now.step));
    within(after + "time", now.time - T, n * eps() * T);
  }
}

/// Snow that comes to rest on rough ground: stress, friction and plastic flow that last.
struct Heap {
  Scene scene = lump_scene();
  State state = small_lump(16, 2, 12, 87);
  Heap() {
    scene.gravity = Vec3(1, 0, -9.8125);
    scene.grid.periodic = spacing * Vec3(4, 4, 0);
    Collider ground;
    ground.shape = HalfSpace{Vec3(0, 0, -1.3 * spacing), Vec3(0, 0, 1)};
    ground.friction = 0.5;
    scene.colliders = {ground};
    for (Vec3& x : state.particles.x) x = scene.wrap(x);
  }
};

bool bits_agree(const Particles& a, const Particles& b) {
  bool same = true;
  for_each_field(
      [&](const char*, const auto& of_a, const auto& of_b) {
        same = same && of_a.size() == of_b.size() &&
               std::memcmp(of_a.data(), of_b.data(), of_a.size() * sizeof(of_a[0])) == 0;
      },
      a, b);
  return same;
}

/// A run without a pause against a chain of fresh solvers, each of which takes a hundred steps
/// and believes that they are the first: a step does not depend on its number.
FIRN_TEST(Scale, steps_of_a_heap) {
  FIRN_NEEDS_SPEED();
  const Heap heap;
  constexpr double dt = 0x1p-12;
  constexpr int link = 100, links = 20;
  const auto solver = make_subject();
  solver->load(heap.scene, heap.state);
  State chain = heap.state, whole;
  std::vector<std::byte> rest;
  for (int k = 0; k < links; ++k) {
    for (int n = 0; n < link; ++n) solver->step(dt);
    solver->store(whole);
    const auto fresh = make_subject();
    chain.time = 0;
    chain.step = 0;
    fresh->load(heap.scene, chain);
    if (!rest.empty()) fresh->load_restart(rest);
    for (int n = 0; n < link; ++n) fresh->step(dt);
    fresh->store(chain);
    rest.resize(fresh->restart_size());
    fresh->store_restart(rest);
    expect(
        "steps do not depend on their number", bits_agree(whole.particles, chain.particles),
        fmt::format("a run of {} steps differs from {} runs of {}", link * (k + 1), k + 1, link));
  }
  double speed = 0, strain = 0;
  for (std::size_t q = 0; q < whole.particles.size(); ++q) {
    speed = std::max(speed, whole.particles.v[q].norm());
    strain = std::max(strain, (whole.particles.F_E[q] - Mat3::Identity()).norm());
  }
  expect("the heap is under stress to the end", strain > 1e-4 && speed < 10,
         fmt::format("strain {:.3g}, speed {:.3g} m/s", strain, speed));
}

/// A lid that sinks, turns and drifts, so that at time T it is where it was at time 0: with
/// α = 1 a particle above takes the share of the nodes below the surface.
FIRN_TEST(Scale, late_times) {
  for (const double T : {0.0, 1.0, 5.0, 64.0, 1024.0, 0x1p20}) {
    if (in_float() && T > 1024) continue;  // time itself has no digits left
    if (subject().slow && T != 5 && T != 1024) continue;
    Scene scene = plain_scene();
    Collider lid;
    const double time = T + 0.375;
    lid.velocity = Vec3(0.5, -0.25, -0x1p-6);
    lid.angular_velocity = Vec3(0, 0, 2);
    const Vec3 now = spacing * Vec3(0.5, 0.25, 0.125);  // a point of the surface, and the axis
    lid.center = now - time * lid.velocity;
    lid.shape = HalfSpace{lid.center, Vec3(0, 0, 1)};
    lid.sticky = true;
    scene.colliders = {lid};
    State state;
    state.time = time;
    Particles& p = state.particles;
    p.resize(1);
    p.x[0] = spacing * Vec3(0.3125, 0.5, 0.25);
    p.v[0] = Vec3(0.5, 0.25, 1);
    p.m[0] = 1;
    p.V_0[0] = spacing * spacing * spacing;
    Vec3 expected = Vec3::Zero();
    for (int i = -1; i <= 2; ++i)
      for (int j = -1; j <= 2; ++j)
        for (int k = -1; k <= 2; ++k) {
          const Vec3 X = p.x[0] / spacing - Vec3(i, j, k);
          const Vec3 x_i = spacing * Vec3(i, j, k);
          const Vec3 v_co = lid.velocity + lid.angular_velocity.cross(x_i - now);
          expected += static_cast<double>(N(X[0]) * N(X[1]) * N(X[2])) * (k <= 0 ? v_co : p.v[0]);
        }
    const State after = run_steps(scene, state, 1, 0x1p-13);
    // c(t) is rounded where it began, and moves by as much as t is rounded.
    const double moved = 2 * eps() * time * lid.velocity.norm();
    within(fmt::format("v_p beside a moving collider, {} s after its start", T),
           (after.particles.v[0] - expected).norm(),
           64 * eps() * 2 + moved * lid.angular_velocity.norm());
  }
}

/// ‖v* − B v‖ of the velocities that a solve returns, not of those that it reports, where it needs
/// some ten iterations and where it needs hundreds.
FIRN_TEST(Scale, iterations_of_a_solve) {
  if (!solves_implicitly()) GTEST_SKIP() << "the solver takes explicit scenes only";
  FIRN_NEEDS_STOP(Stage::grid_collisions);
  FIRN_NEEDS_STOP(Stage::integration);
  Scene scene = lump_scene();
  scene.integrator.type = IntegratorType::semi_implicit;
  scene.integrator.tolerance = in_float() ? 1e-3 : 1e-8;
  scene.integrator.max_iterations = 5000;
  // Stretched: the energy has no direction of negative curvature.
  State state = rounded_snow(60, 3, 88, {.strain = 0.005, .plastic_strain = 0.01});
  for (Mat3& F : state.particles.F_E) F = rounded(Mat3(F + 0.02 * Mat3::Identity()));
  std::int64_t most = 0;
  for (const int power : {-10, -7, -4}) {
    const double dt = std::ldexp(1, power);
    StepReport report;
    const Grid grid = run_through(scene, before_stage(scene, state, Stage::integration, dt),
                                  Stage::integration, dt, &report)
                          .grid;
    most = std::max(most, report.solver_iterations);
    const std::vector<Vec3> none(state.particles.size(), Vec3::Zero());
    const check::Stencils stencils(scene, state.particles, grid, none, 1e-300);
    const std::vector<Vec3> Hv = check::hessian(scene, state.particles, stencils, grid.v_new);
    double residual = 0, size = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const Vec3 r = grid.v_star[i] - grid.v_new[i] - dt * dt / grid.m[i] * Hv[i];
      residual += grid.m[i] * r.squaredNorm();
      size += grid.m[i] * grid.v_star[i].squaredNorm();
    }
    within(fmt::format("residual at Δt = 2^{} s", power), std::sqrt(residual / size),
           2 * scene.integrator.tolerance, fmt::format("{} iterations", report.solver_iterations));
  }
  if (most > 0)
    expect("one of the solves is long", in_float() || most > 100,
           fmt::format("{} iterations", most));
}

}  // namespace
}  // namespace firn::suite
