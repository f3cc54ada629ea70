// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>

#include "reference/stencil.hpp"
#include "verification/tests/reference/scenes.hpp"

namespace firn {
namespace {

using test::Random;

struct Totals {
  double mass = 0;
  Vec3 momentum = Vec3::Zero();
  Vec3 angular_momentum = Vec3::Zero();
  double kinetic_energy = 0;
  double momentum_scale = 0;  ///< Σ m|v|: the size of the terms, which carries the roundoff
};

Totals of_particles(const Particles& p) {
  Totals t;
  for (std::size_t i = 0; i < p.size(); ++i) {
    t.mass += p.m[i];
    t.momentum += p.m[i] * p.v[i];
    t.angular_momentum += p.m[i] * p.x[i].cross(p.v[i]);
    t.kinetic_energy += 0.5 * p.m[i] * p.v[i].squaredNorm();
    t.momentum_scale += p.m[i] * p.v[i].norm();
  }
  return t;
}

Vec3 position(const Scene& scene, const NodeIndex& n) {
  return scene.grid.origin + scene.grid.spacing * Vec3(n.i, n.j, n.k);
}

Totals of_grid(const Scene& scene, const Grid& g, const std::vector<Vec3>& v) {
  Totals t;
  for (std::size_t i = 0; i < g.size(); ++i) {
    t.mass += g.m[i];
    t.momentum += g.m[i] * v[i];
    t.angular_momentum += g.m[i] * position(scene, g.node[i]).cross(v[i]);
    t.kinetic_energy += 0.5 * g.m[i] * v[i].squaredNorm();
  }
  return t;
}

constexpr std::size_t count = 2000;
/// Sums of 64·count rounded terms: √(64·2000)·2^-53 = 4e-14 of Σ|term| is
/// typical, and 1e-13 is kept by the whole catalogue.
constexpr double tolerance = 1e-13;

TEST(Conservation, OneStepStageByStage) {
  Scene scene = test::empty_scene();
  const State initial = test::random_particles(scene, count, 8, 1);
  auto solver = test::make_reference();
  solver->load(scene, initial);
  State state;
  solver->advance_through(Stage::grid_forces, scene.time.step);
  solver->store(state);

  const Totals p = of_particles(initial.particles);
  const Totals g = of_grid(scene, state.grid, state.grid.v);
  EXPECT_NEAR(g.mass, p.mass, tolerance * p.mass);
  EXPECT_LE((g.momentum - p.momentum).norm(), tolerance * p.momentum_scale);
  const double reach = 0.8;  // |x| of particles and nodes [m]
  EXPECT_LE((g.angular_momentum - p.angular_momentum).norm(), tolerance * reach * p.momentum_scale);
  EXPECT_LE(g.kinetic_energy, p.kinetic_energy);

  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  double scale = 0;
  for (std::size_t i = 0; i < state.grid.size(); ++i) {
    force += state.grid.f[i];
    torque += position(scene, state.grid.node[i]).cross(state.grid.f[i]);
    scale += state.grid.f[i].norm();
  }
  EXPECT_GT(scale, 0);
  EXPECT_LE(force.norm(), tolerance * scale);
  EXPECT_LE(torque.norm(), tolerance * scale * reach);
}

/// Without contact the centre of mass falls as a point mass does, whatever the
/// particles do to each other: X0 + nΔtV0 + gΔt² n(n+1)/2.
TEST(Conservation, CentreOfMassFallsFreely) {
  for (const double alpha : {0.0, 0.95, 1.0}) {
    Scene scene = test::empty_scene();
    scene.gravity = Vec3(0.3, -1, -9.81);
    scene.flip = alpha;
    const double dt = scene.time.step;
    auto solver = test::make_reference();
    solver->load(scene, test::random_particles(scene, count, 8, 2));
    const Diagnostics before = solver->diagnostics(scene);
    const int n = 50;
    for (int step = 0; step < n; ++step) solver->step(dt);
    const Diagnostics after = solver->diagnostics(scene);
    const Vec3 expected = before.center_of_mass + n * dt * before.momentum / before.mass +
                          scene.gravity * dt * dt * n * (n + 1) / 2;
    EXPECT_LE((after.center_of_mass - expected).norm(), tolerance) << "alpha " << alpha;
  }
}

/// The angular momentum after a step without contact, from the grid and the
/// particles before it:
///
///     L' = Σ x_i × m_i v_i^{n+1} − Σ_p m_p Σ_i w_ip (x_i − x_p) × (v_i^{n+1} − α v_i^n)
///
/// holds to roundoff for any α and any stress. Thousands of particles which
/// yield, 100 steps.
TEST(Conservation, AngularMomentumIdentity) {
  for (const double alpha : {0.0, 0.95, 1.0}) {
    Scene scene = test::empty_scene();
    scene.flip = alpha;
    const double dt = 2e-4;
    State state = test::random_particles(scene, count, 8, 3);
    const double M = of_particles(state.particles).mass;
    auto solver = test::make_reference();
    solver->load(scene, state);
    double worst = 0, worst_momentum = 0;
    const Totals initial = of_particles(state.particles);
    for (int step = 0; step < 100; ++step) {
      const bool look = step % 20 == 0;
      if (look) solver->store(state);
      const Particles before = state.particles;
      solver->step(dt);
      if (!look) continue;
      solver->store(state);
      const Totals after = of_particles(state.particles);
      worst_momentum = std::max(
          worst_momentum, (after.momentum - initial.momentum).norm() / initial.momentum_scale);

      reference::Stencils stencils;
      std::vector<NodeIndex> node;
      stencils.build(scene, before, Stage::rasterize, node);
      ASSERT_EQ(node, state.grid.node);
      Vec3 expected = of_grid(scene, state.grid, state.grid.v_new).angular_momentum;
      for (std::size_t p = 0; p < before.size(); ++p)
        stencils.for_each_node(p, [&](std::size_t i, double w_ip) {
          expected -= before.m[p] * w_ip *
                      (position(scene, node[i]) - before.x[p])
                          .cross(state.grid.v_new[i] - alpha * state.grid.v[i]);
        });
      worst = std::max(worst, (after.angular_momentum - expected).norm() / (M * 1 * 1));
    }
    // in units of (mass) (speed 1 m/s) (distance 1 m)
    EXPECT_LE(worst, tolerance) << "alpha " << alpha;
    EXPECT_LE(worst_momentum, tolerance) << "alpha " << alpha;
    EXPECT_GT((state.particles.F_P[0] - Mat3::Identity()).norm(), 1e-2);  // it did yield
  }
}

/// A rigid rotation without stress loses ΔL = −(1 − α) M (2h²/3) ω in a step: PIC
/// averages the velocity over a stencil of second moment h²/3 per axis.
TEST(Conservation, PicSlowsARotation) {
  for (const double alpha : {0.0, 0.5, 0.95, 1.0}) {
    Scene scene = test::empty_scene();
    scene.flip = alpha;
    scene.materials[0].youngs_modulus = 1e-12;  // no stress
    const double h = scene.grid.spacing, omega = 2;
    State state;
    for (int i = -12; i < 12; ++i)
      for (int j = -12; j < 12; ++j)
        for (int k = -4; k < 4; ++k) {
          Particles one;
          one.resize(1);
          one.x[0] = h / 2 * Vec3(i + 0.5, j + 0.5, k + 0.5);
          one.v[0] = Vec3(0, 0, omega).cross(one.x[0]);
          one.m[0] = 400 * h * h * h / 8;
          one.V_0[0] = h * h * h / 8;
          state.particles.append(one);
        }
    const Totals before = of_particles(state.particles);
    auto solver = test::make_reference();
    solver->load(scene, state);
    solver->step(1e-9);
    solver->store(state);
    const double lost =
        of_particles(state.particles).angular_momentum[2] - before.angular_momentum[2];
    const double expected = -(1 - alpha) * before.mass * 2 * h * h / 3 * omega;
    // The free surface averages over a one-sided stencil: it changes the loss by a few per cent.
    EXPECT_NEAR(lost, expected, 0.1 * std::abs(expected) + 1e-9 * before.angular_momentum[2])
        << "alpha " << alpha;
  }
}

}  // namespace
}  // namespace firn
