// SPDX-License-Identifier: BSD-3-Clause
// Every built-in scene does what its name says, from beginning to end.

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "firn/diagnostics.hpp"
#include "verification/tests/io/scene/scene_run.hpp"

namespace firn {
namespace {

/// Runs to the end; at 0.25 million particle-steps a second that takes under a minute.
SceneRun finished(const std::string& name) {
  SceneRun run(name);
  run.run();
  EXPECT_LE(static_cast<double>(run.steps) * static_cast<double>(run.state.particles.size()),
            1.5e7);
  const Diagnostics end = run.measure();
  EXPECT_TRUE(std::isfinite(end.kinetic_energy + end.elastic_energy));
  EXPECT_NEAR(run.time, run.scene.time.end, run.scene.time.step + run.scene.time.max_step);
  return run;
}

/// Share of the particles for which `property` of their index holds.
template <class Property>
double share(const Particles& particles, Property property) {
  std::size_t count = 0;
  for (std::size_t p = 0; p < particles.size(); ++p) count += property(p) ? 1 : 0;
  return static_cast<double>(count) / static_cast<double>(particles.size());
}

/// Snow whose J_P has doubled has no strength left: e^{ξ(1−J_P)} < 1e-4.
double broken(const Particles& particles) {
  return share(particles, [&](std::size_t p) { return particles.F_P[p].determinant() > 2; });
}

TEST(BuiltinScene, TwoParticlesBounce) {
  SceneRun run("two_particles");
  const auto& x = run.state.particles.x;
  const auto& v = run.state.particles.v;
  ASSERT_EQ(run.state.particles.size(), 2u);
  EXPECT_LT((v[1] - v[0]).dot(x[1] - x[0]), 0) << "approach";
  run.run(0.02, 1000);
  EXPECT_GT((v[1] - v[0]).dot(x[1] - x[0]), 0) << "and part";
  EXPECT_GT((x[1] - x[0]).norm(), 0);
}

TEST(BuiltinScene, SnowballDropBreaks) {
  const SceneRun run = finished("snowball_drop");
  EXPECT_GT(broken(run.state.particles), 0.5);
  EXPECT_GT(share(run.state.particles,
                  [&](std::size_t p) { return run.state.particles.x[p].head<2>().norm() > 0.15; }),
            0.1)
      << "thrown out beyond the ball's radius of 0.1 m";
}

TEST(BuiltinScene, TinyImpactBreaks) {
  EXPECT_GT(broken(finished("tiny_impact").state.particles), 0.1);
}

TEST(BuiltinScene, SnowballSmashConservesMomentum) {
  const Diagnostics start = SceneRun("snowball_smash").measure();
  const SceneRun run = finished("snowball_smash");
  const Diagnostics end = run.measure();
  const Vec3 expected = start.momentum + start.mass * run.time * run.scene.gravity;
  // n steps, each rounding the sums of some 4e3 terms of size m·5 m/s.
  const double bound =
      static_cast<double>(run.steps) * 16 * std::numeric_limits<double>::epsilon() * start.mass * 5;
  EXPECT_LE((end.momentum - expected).cwiseAbs().maxCoeff(), bound);
  const auto& particles = run.state.particles;
  const auto is = [&](std::int32_t m) {
    return [&, m](std::size_t p) {
      return particles.material[p] == m && particles.F_P[p].determinant() > 2;
    };
  };
  EXPECT_GT(share(particles, is(0)), 0.25) << "the softer ball breaks";
  EXPECT_LT(share(particles, is(1)), 0.05) << "the tougher one stays whole";
}

TEST(BuiltinScene, SnowballSticksToTheWall) {
  const SceneRun run = finished("snowball_wall");
  const Diagnostics end = run.measure();
  EXPECT_LT(end.max_speed, 0.5) << "thrown at 8 m/s";
  EXPECT_GT(end.center_of_mass.x(), -0.08) << "against the wall at x = 0.007";
  EXPECT_GT(end.center_of_mass.z(), 0.28) << "above the ground";
  EXPECT_LT(end.dt + run.solver->choose_time_step().dt, run.scene.time.max_step / 2)
      << "compacted snow needs shorter steps";
}

TEST(BuiltinScene, SnowPlowPilesUpSnow) {
  const SceneRun run = finished("snow_plow");
  const double blade = -0.053 + 2.0 * run.time;
  const auto& x = run.state.particles.x;
  EXPECT_GT(share(run.state.particles,
                  [&](std::size_t p) { return x[p].z() > 0.09 && x[p].x() > blade - 0.05; }),
            0.03)
      << "above the bed of 0.07 m, at the blade";
  EXPECT_LT(share(run.state.particles,
                  [&](std::size_t p) {
                    return x[p].z() > 0.03 && x[p].x() < blade - 0.06 && std::abs(x[p].y()) < 0.04;
                  }),
            0.05)
      << "a track behind it";
}

TEST(BuiltinScene, WedgeSplitsTheBall) {
  const SceneRun run = finished("wedge");
  const auto& x = run.state.particles.x;
  const double left = share(run.state.particles, [&](std::size_t p) { return x[p].x() < -0.1; });
  const double right = share(run.state.particles, [&](std::size_t p) { return x[p].z() < -0.1; });
  EXPECT_GT(left, 0.25);
  EXPECT_GT(right, 0.25);
  // The scene is symmetric but for the jitter of 3000 particles: √3000/3000 is 2 %, and
  // five seeds parted by at most as much. A normal that prefers one face of the edge
  // showed up here as 39 : 59.
  EXPECT_NEAR(left, right, 0.06);
  EXPECT_EQ(share(run.state.particles,
                  [&](std::size_t p) { return x[p].x() < -0.02 && x[p].z() < -0.02; }),
            0)
      << "none a cell deep inside the wedge";
}

TEST(BuiltinScene, ColumnSettlesToTheClosedForm) {
  const SceneRun run = finished("column");
  const Material& material = run.scene.materials[0];
  const double M = material.lambda_0() + 2 * material.mu_0(), g = 9.81, H = 0.5, h = 0.05;
  const double base_strain = material.density * g * H / M;
  const Diagnostics end = run.measure();
  EXPECT_LT(end.max_speed, 0.01);
  // u(X) = −(ρg/M)(HX − X²/2), whose mean over the column is −ρgH²/(3M). Held
  // nodes and kernels blur the base over 2 h, where the strain is ρgH/M.
  EXPECT_NEAR(end.center_of_mass.z(), H / 2 - base_strain * H / 3, 2 * h * base_strain);
}

TEST(BuiltinScene, SnowballRollsAndGathersSnow) {
  const SceneRun run = finished("rolling_snowball");
  const auto& particles = run.state.particles;
  Vec3 ball = Vec3::Zero();
  double count = 0;
  for (std::size_t p = 0; p < particles.size(); ++p)
    if (particles.material[p] == 0) ball += particles.x[p], count += 1;
  ball /= count;
  EXPECT_GT(ball.x(), 0.4) << "3 m/s for 0.2 s";
  EXPECT_GT(
      share(particles,
            [&](std::size_t p) { return particles.material[p] == 1 && particles.x[p].z() > 0.06; }),
      0.002)
      << "loose snow lifted off its bed of 0.04 m";
}

TEST(BuiltinScene, StiffBlockLandsAndStays) {
  const SceneRun run = finished("stiff_block");
  const Diagnostics end = run.measure();
  EXPECT_LT(end.max_speed, 0.5) << "it came at 1.6 m/s";
  EXPECT_GT(end.center_of_mass.z(), 0.1);
  EXPECT_LT(end.center_of_mass.z(), 0.15) << "half its height, on the ground";
}

TEST(BuiltinScene, PeriodicShearSlowsDownAndKeepsItsMomentum) {
  const Diagnostics start = SceneRun("shear_periodic").measure();
  const SceneRun run = finished("shear_periodic");
  const Diagnostics end = run.measure();
  const double bound = static_cast<double>(run.steps) * 16 *
                       std::numeric_limits<double>::epsilon() * start.mass * 1.5;
  EXPECT_LE((end.momentum - start.momentum).cwiseAbs().maxCoeff(), bound);
  EXPECT_LT(end.kinetic_energy, 0.1 * start.kinetic_energy);
}

TEST(BuiltinScene, DrumCarriesTheSnowUp) {
  const SceneRun run = finished("drum");
  const Vec3 X = run.measure().center_of_mass;
  EXPECT_LT(X.x(), -0.05) << "the wall below moves towards −x";
  EXPECT_LT((X - Vec3(0, 0, 0.211)).norm(), 0.2) << "inside";
}

}  // namespace
}  // namespace firn
