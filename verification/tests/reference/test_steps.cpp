// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Dense>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "reference/constitutive.hpp"
#include "reference/exp.hpp"
#include "reference/polar.hpp"
#include "reference/steps.hpp"
#include "verification/support/eps.hpp"
#include "verification/tests/reference/scenes.hpp"

namespace firn::reference {
namespace {

/// Particles and the grid around them, in the middle of nothing.
struct Small {
  explicit Small(std::size_t n = 1) : particles(test::particles_at_rest(scene, n).particles) {}

  void rasterize() {
    stencils.build(scene, particles, Stage::rasterize, grid.node);
    reference::rasterize(particles, stencils, grid);
  }
  /// Sets v_i^{n+1} = f(x_i) on the grid.
  template <class Field>
  void set_v_new(const Field& field) {
    grid.v_new.clear();
    for (const NodeIndex& n : grid.node)
      grid.v_new.push_back(field(scene.grid.spacing * Vec3(n.i, n.j, n.k)));
  }
  std::size_t place(const NodeIndex& n) const {
    return static_cast<std::size_t>(std::find(grid.node.begin(), grid.node.end(), n) -
                                    grid.node.begin());
  }

  Scene scene = test::empty_scene();
  Particles particles;
  Stencils stencils;
  Grid grid;
};

TEST(Step01Rasterize, OneParticleInTheMiddleOfACell) {
  Small s;
  s.particles.v[0] = Vec3(1, 2, 3);
  s.rasterize();
  // N(±½) = 23/48, N(±1½) = 1/48
  EXPECT_NEAR(s.grid.m[s.place({0, 0, 0})], std::pow(23.0 / 48, 3), 4 * eps);
  EXPECT_NEAR(s.grid.m[s.place({-1, 1, 2})], 23.0 / 48 / 48 / 48, eps);
  for (const Vec3& v_i : s.grid.v) EXPECT_LE((v_i - Vec3(1, 2, 3)).norm(), 4 * eps);
}

TEST(Step01Rasterize, VelocityIsTheMassWeightedMean) {
  Small s(2);
  s.particles.m = {1, 3};
  s.particles.v = {Vec3(4, 0, 0), Vec3(0, 4, 0)};
  s.rasterize();
  for (const Vec3& v_i : s.grid.v) EXPECT_LE((v_i - Vec3(1, 3, 0)).norm(), 4 * eps);
}

TEST(Step01Rasterize, OnANodeThe27NodesWithinReachHaveMass) {
  Small s;
  s.scene.grid.spacing = 0.5;
  s.particles.x[0] = Vec3(1, -0.5, 0);
  s.particles.v[0] = Vec3(1, 0, 0);
  s.rasterize();
  EXPECT_EQ(s.grid.size(), 64u);
  int massive = 0;
  for (std::size_t i = 0; i < s.grid.size(); ++i) {
    massive += s.grid.m[i] > 0;
    if (s.grid.m[i] == 0) {
      EXPECT_EQ(s.grid.v[i], Vec3(Vec3::Zero()));
    }
  }
  EXPECT_EQ(massive, 27);
}

/// However light a node is, its velocity is that of the particles: m_i = 1e-42 here.
TEST(Step01Rasterize, LightNodesTakePart) {
  Small s;
  s.scene.grid.spacing = 1;
  s.particles.x[0] = Vec3::Constant(1e-14);
  s.particles.v[0] = Vec3(1, 2, 3);
  s.rasterize();
  const std::size_t far = s.place({2, 2, 2});
  EXPECT_GT(s.grid.m[far], 0);
  EXPECT_LT(s.grid.m[far], 1e-42);
  EXPECT_LE((s.grid.v[far] - Vec3(1, 2, 3)).norm(), 4 * eps);
  // And gravity reaches it as well as the others.
  s.scene.gravity = Vec3(0, 0, -10);
  s.grid.f.assign(s.grid.size(), Vec3::Zero());
  grid_velocities(s.scene, 0.1, s.grid);
  EXPECT_LE((s.grid.v_star[far] - Vec3(1, 2, 2)).norm(), 8 * eps);
}

/// A mass so small that m_i underflows: the node takes no part, nothing is NaN.
TEST(Step01Rasterize, MassesThatUnderflow) {
  Small s;
  s.particles.m[0] = 1e-310;
  s.particles.v[0] = Vec3(1, 0, 0);
  s.rasterize();
  for (const Vec3& v_i : s.grid.v) EXPECT_TRUE(v_i.allFinite());
}

TEST(Step02Volumes, LatticeHasTheVolumeOfItsCells) {
  // 8 particles per cell in a block: inside, the density is that of the material, m_p 8/h³.
  Small s(0);
  const double h = s.scene.grid.spacing;
  s.particles = Particles{};
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      for (int k = 0; k < 12; ++k) {
        Particles one;
        one.resize(1);
        one.x[0] = h / 2 * Vec3(i + 0.5, j + 0.5, k + 0.5);
        one.m[0] = 400 * h * h * h / 8;
        s.particles.append(one);
      }
  s.rasterize();
  volumes(s.scene, s.stencils, s.grid, s.particles);
  const std::size_t middle = (6 * 12 + 6) * 12 + 6;
  // Sampled twice by a spline of order 4 at two points per cell: 1e-3 of the density
  EXPECT_NEAR(s.particles.V_0[middle], h * h * h / 8, 1e-3 * h * h * h / 8);
  EXPECT_GT(s.particles.V_0[0], 2 * s.particles.V_0[middle]);  // at a corner it looks thinner
}

TEST(Step02Volumes, LoneParticle) {
  // ρ = Σ m_i w_i/h³ = m (Σ w²)³/h³ with Σ w² = 2(23² + 1)/48² per axis in the middle of a cell
  Small s;
  s.rasterize();
  volumes(s.scene, s.stencils, s.grid, s.particles);
  const double h = s.scene.grid.spacing, sum = 2 * (23.0 * 23 + 1) / (48 * 48);
  EXPECT_NEAR(s.particles.V_0[0], std::pow(h / sum, 3), 20 * eps * std::pow(h / sum, 3));
}

TEST(Step02Volumes, OnlyWhereTheyAreNotKnown) {
  Small s(2);
  s.particles.V_0 = {0.125, 0};
  s.rasterize();
  volumes(s.scene, s.stencils, s.grid, s.particles);
  EXPECT_EQ(s.particles.V_0[0], 0.125);
  EXPECT_GT(s.particles.V_0[1], 0);
  const double estimated = s.particles.V_0[1];
  s.particles.x[1] += Vec3::Constant(0.02);
  s.rasterize();
  volumes(s.scene, s.stencils, s.grid, s.particles);
  EXPECT_EQ(s.particles.V_0[1], estimated);
}

TEST(Step03GridForces, UniaxialStretchPullsTheNodesTogether) {
  Small s;
  s.particles.V_0[0] = 1e-3;
  const double F = 1.01;
  s.particles.F_E[0] = Vec3(F, 1, 1).asDiagonal();
  s.rasterize();
  grid_forces(s.scene, s.particles, s.stencils, s.grid);
  const Material& snow = s.scene.materials[0];
  const double mu = snow.mu_0(), lambda = snow.lambda_0(), h = s.scene.grid.spacing;
  // τ11 = (λ+2μ)(F−1)F, τ22 = τ33 = λ(F−1)F; in the middle of a cell N' = ∓5/8, ∓1/8
  const double N_0 = 23.0 / 48, dN_0 = 0.625 / h;
  const double tau_1 = (lambda + 2 * mu) * (F - 1) * F, tau_2 = lambda * (F - 1) * F;
  const Vec3 expected = -1e-3 * Vec3(tau_1, tau_2, tau_2) * dN_0 * N_0 * N_0;
  // node 1 lies half a cell beyond the particle, where ∇w points away from it
  const Vec3 f = s.grid.f[s.place({1, 1, 1})];
  EXPECT_LE((f - expected).norm(), 1e-12 * expected.norm());  // F − 1 loses two digits
  EXPECT_LT(f[0], 0);
}

TEST(Step03GridForces, PlasticCompressionHardens) {
  Small s;
  s.particles.V_0[0] = 1e-3;
  s.particles.F_E[0] = Vec3(1.01, 1, 0.99).asDiagonal();
  s.rasterize();
  grid_forces(s.scene, s.particles, s.stencils, s.grid);
  const std::vector<Vec3> soft = s.grid.f;
  s.particles.F_P[0] = Vec3(0.9, 1, 1).asDiagonal();
  grid_forces(s.scene, s.particles, s.stencils, s.grid);
  for (std::size_t i = 0; i < soft.size(); ++i)
    EXPECT_LE((s.grid.f[i] - std::exp(1.0) * soft[i]).norm(), 20 * eps * soft[i].norm());
  // ξ = 0: F_P does not matter at all
  s.scene.materials[0].hardening = 0;
  s.particles.F_P[0] = 0.8 * Mat3::Identity();
  grid_forces(s.scene, s.particles, s.stencils, s.grid);
  EXPECT_EQ(s.grid.f, soft);
}

TEST(Step03GridForces, RotationIsNoStrain) {
  Small s;
  s.particles.V_0[0] = 1e-3;
  test::Random random(1);
  s.particles.F_E[0] = rotation(random.mat3());
  s.rasterize();
  grid_forces(s.scene, s.particles, s.stencils, s.grid);
  const double scale = 1e-3 * s.scene.materials[0].mu_0() / s.scene.grid.spacing;
  for (const Vec3& f_i : s.grid.f) EXPECT_LE(f_i.norm(), 20 * eps * scale);
}

TEST(Step04GridVelocities, ForceAndGravity) {
  Small s;
  s.rasterize();
  s.scene.gravity = Vec3(0, 0, -10);
  s.grid.v.assign(s.grid.size(), Vec3(1, 0, 0));
  s.grid.f.assign(s.grid.size(), Vec3::Zero());
  const std::size_t i = s.place({0, 0, 0});
  s.grid.f[i] = Vec3(0, 2, 0);
  grid_velocities(s.scene, 0.5, s.grid);
  EXPECT_EQ(s.grid.v_star[i], Vec3(1, 0.5 * (2 / s.grid.m[i]), -5));
  EXPECT_EQ(s.grid.v_star[s.place({1, 0, 0})], Vec3(1, 0, -5));
}

TEST(Step07Deformation, FollowsALinearVelocityField) {
  Small s;
  s.scene.materials[0].critical_compression = s.scene.materials[0].critical_stretch =
      std::numeric_limits<double>::infinity();
  test::Random random(2);
  const Mat3 G = random.mat3(), F_E = Mat3::Identity() + 0.1 * random.mat3();
  const Mat3 F_P = Mat3::Identity() + 0.1 * random.mat3();
  s.particles.F_E[0] = F_E;
  s.particles.F_P[0] = F_P;
  s.rasterize();
  s.set_v_new([&](const Vec3& x) -> Vec3 { return Vec3(1, 2, 3) + G * x; });
  deformation(s.scene, s.stencils, s.grid, 0.25, s.particles);
  const Mat3 expected = (Mat3::Identity() + 0.25 * G) * F_E;
  // Σ v_i ∇w: velocities of size 3 over 1/h = 10, 64 terms
  EXPECT_LE((s.particles.F_E[0] - expected).norm(), 100 * eps);
  EXPECT_EQ(s.particles.F_P[0], F_P);  // elastic: to the last bit
}

TEST(Step07Deformation, ClampsToTheElasticLimits) {
  const Material snow;
  test::Random random(3);
  for (int n = 0; n < 200; ++n) {
    Small s;
    s.particles.F_E[0] = Mat3::Identity() + 0.01 * random.mat3();
    s.particles.F_P[0] = Mat3::Identity() + 0.1 * random.mat3();
    const Mat3 F_P_before = s.particles.F_P[0];
    const Mat3 G = 2 * random.mat3();
    const double dt = 0.1;  // strains of 20 %
    const Mat3 F_E_hat = (Mat3::Identity() + dt * G) * s.particles.F_E[0];
    s.rasterize();
    s.set_v_new([&](const Vec3& x) -> Vec3 { return G * x; });
    deformation(s.scene, s.stencils, s.grid, dt, s.particles);
    const Mat3 &F_E = s.particles.F_E[0], &F_P = s.particles.F_P[0];
    const double tolerance = 100 * eps;  // roundoff of ∇v, as above

    // F_E F_P = F^{n+1}: what was split off is not lost
    EXPECT_LE((F_E * F_P - F_E_hat * F_P_before).norm(), tolerance);
    const Svd before = svd(F_E_hat), after = svd(F_E);
    double J_ratio = 1;
    for (int k = 0; k < 3; ++k) {
      const double clamped = std::min(std::max(before.sigma[k], 1 - 2.5e-2), 1 + 7.5e-3);
      EXPECT_NEAR(after.sigma[k], clamped, tolerance);
      J_ratio *= before.sigma[k] / clamped;
    }
    EXPECT_NEAR(F_P.determinant(), F_P_before.determinant() * J_ratio, tolerance);
    // The rotation is that of F̂_E.
    EXPECT_LE((rotation(F_E) - rotation(F_E_hat)).norm(), tolerance);

    // Idempotent: without motion nothing more flows.
    const Mat3 F_E_once = F_E, F_P_once = F_P;
    s.set_v_new([](const Vec3&) -> Vec3 { return Vec3::Zero(); });
    deformation(s.scene, s.stencils, s.grid, dt, s.particles);
    EXPECT_LE((s.particles.F_E[0] - F_E_once).norm(), 32 * eps);
    EXPECT_LE((s.particles.F_P[0] - F_P_once).norm(), 32 * eps);
  }
}

TEST(Step07Deformation, ContinuousAtTheLimits) {
  // σ̂ = 1 + θ_s ± δ: F_E and F_P change by no more than about δ
  for (const double limit : {1 + 7.5e-3, 1 - 2.5e-2}) {
    Small below, above;
    const double delta = 1e-9;
    below.particles.F_E[0] = Vec3(limit - delta, 1, 1).asDiagonal();
    above.particles.F_E[0] = Vec3(limit + delta, 1, 1).asDiagonal();
    for (Small* s : {&below, &above}) {
      s->rasterize();
      s->set_v_new([](const Vec3&) -> Vec3 { return Vec3::Zero(); });
      deformation(s->scene, s->stencils, s->grid, 0.1, s->particles);
    }
    EXPECT_LE((below.particles.F_E[0] - above.particles.F_E[0]).norm(), 3 * delta);
    EXPECT_LE((below.particles.F_P[0] - above.particles.F_P[0]).norm(), 3 * delta);
  }
}

/// det F̂_E ≤ 0: σ3 carries the sign and is clamped like any other; F_E becomes a
/// proper deformation again and the rest goes to F_P.
TEST(Step07Deformation, InvertedAndFlatParticles) {
  for (const double s3 : {0.0, -0.5, -1.0}) {
    Small s;
    s.particles.F_E[0] = Vec3(1, 1, s3).asDiagonal();
    s.rasterize();
    s.set_v_new([](const Vec3&) -> Vec3 { return Vec3::Zero(); });
    deformation(s.scene, s.stencils, s.grid, 0.1, s.particles);
    EXPECT_NEAR(s.particles.F_E[0].determinant(), 1 - 2.5e-2, 10 * eps);
    const Mat3 F = s.particles.F_E[0] * s.particles.F_P[0];
    EXPECT_LE((F - Mat3(Vec3(1, 1, s3).asDiagonal())).norm(), 10 * eps);
  }
  // Δt ∇v = −I: F̂_E = 0 at one stroke
  Small s;
  s.rasterize();
  s.set_v_new([](const Vec3& x) -> Vec3 { return -10 * x; });
  deformation(s.scene, s.stencils, s.grid, 0.1, s.particles);
  EXPECT_NEAR(s.particles.F_E[0].determinant(), std::pow(1 - 2.5e-2, 3), 20 * eps);
  EXPECT_LE((s.particles.F_E[0] * s.particles.F_P[0]).norm(), 100 * eps);
}

TEST(Step08ParticleVelocities, BlendsPicAndFlip) {
  Small s(2);
  s.particles.v = {Vec3(1, 0, 0), Vec3(0, 3, 0)};
  s.rasterize();  // v_i = (½, 3/2, 0) everywhere
  s.set_v_new([](const Vec3&) -> Vec3 { return Vec3(0, 0, 4); });
  for (const double alpha : {0.0, 0.95, 1.0}) {
    Particles after = s.particles;
    s.scene.flip = alpha;
    particle_velocities(s.scene, s.stencils, s.grid, after);
    const Vec3 v_PIC(0, 0, 4), v_FLIP = Vec3(1, 0, 0) + Vec3(-0.5, -1.5, 4);
    EXPECT_LE((after.v[0] - ((1 - alpha) * v_PIC + alpha * v_FLIP)).norm(), 20 * eps);
  }
}

TEST(Step10Positions, MoveAndWrap) {
  Small s(2);
  s.scene.grid.periodic = Vec3(1, 0, 0);
  s.particles.x = {Vec3(0.9, 0.5, 0.5), Vec3(0.1, 0.5, 0.5)};
  s.particles.v = {Vec3(2, 2, 2), Vec3(-2, 0, 0)};
  positions(s.scene, 0.125, s.particles);
  EXPECT_NEAR(s.particles.x[0][0], 0.15, 4 * eps);
  EXPECT_EQ(s.particles.x[0][1], 0.75);
  EXPECT_NEAR(s.particles.x[1][0], 0.85, 4 * eps);
}

}  // namespace
}  // namespace firn::reference
