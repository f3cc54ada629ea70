// SPDX-License-Identifier: BSD-3-Clause
/// What is conserved, exactly, whatever the particles do to each other.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "verification/suite/probes.hpp"

namespace firn::suite {
namespace {

/// Sums of 64 n rounded terms wander by √(64 n) roundings, 360 for n = 2000; 450 roundings are
/// 1e-13 in double.
double tolerance() { return 450 * eps(); }

/// n particles of snow with random masses, velocities and deformations, many of them beyond the
/// elastic limits, in a cube of `cells` cells around the origin.
struct RandomSnow {
  Scene scene = plain_scene();
  State state;

  RandomSnow(std::size_t n, double cells, std::uint64_t seed)
      : state(rounded_snow(n, cells, seed)) {
    Material snow;
    snow.name = "snow";
    scene.materials = {snow};
    for (double& V_0 : state.particles.V_0) V_0 = 0;  // to be estimated
  }
};

std::size_t particle_count() { return static_cast<std::size_t>(effort(2000, 200)); }
int step_count() { return effort(200, 10); }

FIRN_TEST(Conservation, from_particles_to_the_grid) {
  FIRN_NEEDS_STOP(Stage::grid_forces);
  const RandomSnow snow(particle_count(), 8, 1);
  const State state = run_through(snow.scene, snow.state, Stage::grid_forces, 1e-4);
  const Totals p = totals(snow.state.particles), g = totals(snow.scene, state.grid, state.grid.v);
  within("Σ m_i = Σ m_p", g.mass - p.mass, tolerance() * p.mass);
  within("momentum of P2G", (g.momentum - p.momentum).norm(), tolerance() * p.momentum_scale);
  within("angular momentum of P2G", (g.angular_momentum - p.angular_momentum).norm(),
         tolerance() * (p.angular_scale + 2 * spacing * p.momentum_scale));
  within("kinetic energy of the grid is not larger",
         std::max(0.0, g.kinetic_energy - p.kinetic_energy), tolerance() * p.kinetic_energy);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  double scale = 0, torque_scale = 0;
  for (std::size_t i = 0; i < state.grid.size(); ++i) {
    const Vec3 x_i = position(snow.scene, state.grid.node[i]);
    force += state.grid.f[i];
    torque += x_i.cross(state.grid.f[i]);
    scale += state.grid.f[i].norm();
    torque_scale += x_i.norm() * state.grid.f[i].norm();
  }
  // Forces of neighbours cancel at a node: what it sums is several times what remains.
  within("Σ f_i = 0", force.norm(), 8 * tolerance() * scale);
  within("Σ x_i × f_i = 0", torque.norm(), 8 * tolerance() * torque_scale);
  expect("there are forces", scale > 0);
}

/// Every stage of every step, α = 0, 0.95, 1: momentum, centre of mass, angular momentum.
void free_flight(double alpha) {
  RandomSnow snow(particle_count(), 8, 2);
  Scene& scene = snow.scene;
  scene.flip = alpha;
  scene.gravity = Vec3(0.25, -1, -9.8125);
  const double dt = 0x1p-12;
  const Totals initial = totals(snow.state.particles);
  Vec3 X0 = Vec3::Zero();
  double x_scale = 0;
  for (std::size_t q = 0; q < snow.state.particles.size(); ++q) {
    X0 += snow.state.particles.m[q] * snow.state.particles.x[q] / initial.mass;
    x_scale = std::max(x_scale, snow.state.particles.x[q].norm());
  }
  const Vec3 V0 = initial.momentum / initial.mass;
  const auto solver = make_subject();
  solver->load(scene, snow.state);
  State state = snow.state;
  const bool grid_is_seen = stops_at(Stage::integration);
  const int steps = step_count(), looks = 8;
  double yielded = 0;
  for (int n = 1; n <= steps; ++n) {
    const bool look = n % std::max(1, steps / looks) == 0;
    if (!look) {
      solver->step(dt);
      continue;
    }
    solver->store(state);
    const Particles before = state.particles;
    Grid grid;
    if (grid_is_seen) {
      solver->advance_through(Stage::integration, dt);
      solver->store(state);
      grid = state.grid;
    }
    solver->advance_through(Stage::positions, dt);
    solver->store(state);
    const Totals after = totals(state.particles);
    // n steps of sums that each wander by a rounding or so of Σ m|v|: √n of the above.
    const double grown = std::sqrt(static_cast<double>(n));
    const Vec3 momentum = initial.momentum + n * dt * scene.gravity * initial.mass;
    within("momentum", (after.momentum - momentum).norm(),
           tolerance() * (after.momentum_scale + initial.momentum_scale));
    within("mass", after.mass - initial.mass, tolerance() * initial.mass);
    Vec3 X = Vec3::Zero();
    for (std::size_t q = 0; q < state.particles.size(); ++q)
      X += state.particles.m[q] * state.particles.x[q] / initial.mass;
    const Vec3 fall = X0 + n * dt * V0 + scene.gravity * dt * dt * n * (n + 1) / 2;
    within("centre of mass X0 + nΔtV0 + gΔt² n(n+1)/2", (X - fall).norm(),
           tolerance() * (x_scale + n * dt * 2) * (in_float() ? 0.1 * grown : 1));
    if (!grid_is_seen) continue;
    // L' = Σ x_i × m_i v_i^{n+1} − Σ_p m_p Σ_i w_ip (x_i − x_p) × (v_i^{n+1} − α v_iⁿ), with the
    // weights in extended precision. The particles move along their velocities: x × v stays.
    Vec3 expected = totals(scene, grid, grid.v_new).angular_momentum;
    double scale = 0;
    for (std::size_t p = 0; p < before.size(); ++p)
      for_each_weight(scene, grid, before.x[p], [&](std::size_t i, double w_ip) {
        const Vec3 arm = position(scene, grid.node[i]) - before.x[p];
        expected -= before.m[p] * w_ip * arm.cross(grid.v_new[i] - alpha * grid.v[i]);
        scale += before.m[p] * w_ip * grid.v_new[i].norm() * (arm.norm() + before.x[p].norm());
      });
    within("angular momentum", (after.angular_momentum - expected).norm(), tolerance() * scale);
    const Totals old_grid = totals(scene, grid, grid.v);
    within("kinetic energy of the grid is not larger",
           std::max(0.0, old_grid.kinetic_energy - totals(before).kinetic_energy),
           tolerance() * totals(before).kinetic_energy);
  }
  for (const Mat3& F_P : state.particles.F_P)
    yielded = std::max(yielded, (F_P - Mat3::Identity()).norm());
  expect("the snow has yielded", yielded > 1e-2);
}

FIRN_TEST(Conservation, free_flight_alpha_0) { free_flight(0); }
FIRN_TEST(Conservation, free_flight_alpha_095) { free_flight(0.95); }
FIRN_TEST(Conservation, free_flight_alpha_1) { free_flight(1); }

/// Without stress a rigid rotation loses ΔL = −(1 − α) M (2h²/3) ω per step, nothing at α = 1.
FIRN_TEST(Conservation, rigid_rotation_is_damped_by_pic_alone) {
  for (const double alpha : {0.0, 0.5, 0.95, 1.0}) {
    Scene scene = plain_scene();
    scene.flip = alpha;
    scene.materials[0].youngs_modulus = 1e-12;
    const double h = spacing, omega = 2;
    State state;
    Particles& p = state.particles;
    const int n = effort(12, 6);
    std::vector<Vec3> x;
    for (int i = -n; i < n; ++i)
      for (int j = -n; j < n; ++j)
        for (int k = -4; k < 4; ++k) x.push_back(h / 2 * Vec3(i + 0.5, j + 0.5, k + 0.5));
    p.resize(x.size());
    p.x = x;
    for (std::size_t q = 0; q < x.size(); ++q) {
      p.v[q] = rounded(Vec3(Vec3(0, 0, omega).cross(x[q])));
      p.m[q] = p.V_0[q] = 0x1p-15;
      p.id[q] = static_cast<std::int64_t>(q);
    }
    const Totals before = totals(p);
    const State after = run_steps(scene, state, 1, 0x1p-20);
    const double lost = totals(after.particles).angular_momentum[2] - before.angular_momentum[2];
    const double expected = -(1 - alpha) * before.mass * 2 * h * h / 3 * omega;
    // The free surface averages over a one-sided stencil: a few per cent of the loss, more of a
    // small body; positions move by ωΔt.
    const double surface = n < 12 ? 0.2 : 0.1;
    within(fmt::format("loss of a rigid rotation, alpha = {}", alpha), lost - expected,
           surface * std::abs(expected) +
               (tolerance() + 4 * omega * 0x1p-20) * before.angular_momentum[2]);
  }
}

}  // namespace
}  // namespace firn::suite
