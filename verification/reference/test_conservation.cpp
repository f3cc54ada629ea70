#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>

#include "verification/reference/scenes.hpp"

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
    const Diagnostics before = solver->diagnostics();
    const int n = 50;
    for (int step = 0; step < n; ++step) solver->step(dt);
    const Diagnostics after = solver->diagnostics();
    const Vec3 expected = before.center_of_mass + n * dt * before.momentum / before.mass +
                          scene.gravity * dt * dt * n * (n + 1) / 2;
    EXPECT_LE((after.center_of_mass - expected).norm(), tolerance) << "alpha " << alpha;
  }
}

}  // namespace
}  // namespace firn
