// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Dense>
#include <Eigen/SVD>
#include <cmath>
#include <gtest/gtest.h>

#include "reference/implicit_system.hpp"
#include "reference/steps.hpp"
#include "verification/tests/reference/scenes.hpp"

namespace firn::reference {
namespace {

using test::Random;

Scene implicit_scene(double beta = 1) {
  Scene scene = test::empty_scene();
  scene.integrator.type = IntegratorType::semi_implicit;
  scene.integrator.implicitness = beta;
  scene.integrator.tolerance = 1e-12;
  return scene;
}

/// A scene run up to the stage before the solve, with everything a test needs to look inside.
struct Prepared {
  Prepared(const Scene& s, State state, double dt, double time = 0)
      : scene(s), particles(std::move(state.particles)) {
    stencils.build(scene, particles, Stage::rasterize, grid.node);
    rasterize(particles, stencils, grid);
    volumes(scene, stencils, grid, particles);
    grid_forces(scene, particles, stencils, grid);
    grid_velocities(scene, dt, grid);
    grid_collisions(scene, time, grid);
  }
  Scene scene;
  Particles particles;
  Stencils stencils;
  Grid grid;
};

NodeField random_field(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  NodeField u(n);
  for (Vec3& u_i : u) u_i = random.vec3();
  return u;
}

double dot(const NodeField& a, const NodeField& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

double norm(const NodeField& a) { return std::sqrt(dot(a, a)); }

NodeField minus(NodeField a, const NodeField& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

/// F̂_E of particle p when the nodes have moved by s u.
Mat3 moved_F_E(const Prepared& s, std::size_t p, const NodeField& u, double scale) {
  Mat3 G = Mat3::Zero();
  s.stencils.for_each_node_with_gradient(
      p, [&](std::size_t i, double, const Vec3& grad_w_ip) { G += u[i] * grad_w_ip.transpose(); });
  return (Mat3::Identity() + scale * G) * s.particles.F_E[p];
}

/// The forces of step 3's energy at nodes moved by scale·u; P by Eigen's SVD.
NodeField force_at(const Prepared& s, const NodeField& u, double scale) {
  NodeField f(u.size(), Vec3::Zero());
  for (std::size_t p = 0; p < s.particles.size(); ++p) {
    const Mat3 F = moved_F_E(s, p, u, scale);
    const Eigen::JacobiSVD<Mat3> usv(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Mat3 R = usv.matrixU() * usv.matrixV().transpose();
    const Material& material = s.scene.materials[0];
    const double hard = std::exp(material.hardening * (1 - s.particles.F_P[p].determinant()));
    const double J = F.determinant();
    const Mat3 P = hard * (2 * material.mu_0() * (F - R) +
                           material.lambda_0() * (J - 1) * J * F.inverse().transpose());
    const Mat3 V_P_FT = s.particles.V_0[p] * P * s.particles.F_E[p].transpose();
    s.stencils.for_each_node_with_gradient(
        p, [&](std::size_t i, double, const Vec3& grad_w_ip) { f[i] -= V_P_FT * grad_w_ip; });
  }
  return f;
}

double energy_at(const Prepared& s, const NodeField& u, double scale) {
  double energy = 0;
  for (std::size_t p = 0; p < s.particles.size(); ++p)
    energy += s.particles.V_0[p] * energy_density(lame(s.scene.materials[0], s.particles.F_P[p]),
                                                  moved_F_E(s, p, u, scale));
  return energy;
}

TEST(Implicit, ForceIsMinusTheGradientOfTheEnergy) {
  const Scene scene = implicit_scene();
  const Prepared s(scene, test::random_particles(scene, 40, 3, 1), 1e-4);
  const NodeField u = random_field(s.grid.size(), 2);
  const double step = 1e-4 * scene.grid.spacing;
  const double slope = (8 * (energy_at(s, u, step) - energy_at(s, u, -step)) -
                        (energy_at(s, u, 2 * step) - energy_at(s, u, -2 * step))) /
                       (12 * step);
  // Fourth order differences: (step/h)⁴ = 1e-16 of truncation, eps/(step/h) = 1e-12 of roundoff,
  // both in units of the energy's change over a strain of 1, which is the scale below.
  double scale = 0;
  for (std::size_t i = 0; i < u.size(); ++i) scale += u[i].norm() * s.grid.f[i].norm();
  EXPECT_NEAR(slope, -dot(s.grid.f, u), 1e-9 * scale);
}

TEST(Implicit, HessianIsTheDerivativeOfTheForce) {
  const Scene scene = implicit_scene();
  const Prepared s(scene, test::random_particles(scene, 40, 3, 3), 1e-4);
  const ImplicitSystem system(s.scene, s.particles, s.stencils, s.grid, 1e-4);
  const NodeField u = random_field(s.grid.size(), 4);
  const NodeField Hu = system.hessian(u);
  const double step = 1e-4 * scene.grid.spacing;
  const NodeField far_1 = force_at(s, u, 2 * step), far_2 = force_at(s, u, -2 * step);
  const NodeField near_1 = force_at(s, u, step), near_2 = force_at(s, u, -step);
  NodeField differences(u.size());
  for (std::size_t i = 0; i < u.size(); ++i)
    differences[i] = -(8 * (near_1[i] - near_2[i]) - (far_1[i] - far_2[i])) / (12 * step);
  // As above, 1e-12 of roundoff for strains of size 1; here u/h is of that size.
  EXPECT_LE(norm(minus(differences, Hu)), 1e-9 * norm(Hu));
}

TEST(Implicit, HessianIsSymmetric) {
  const Scene scene = implicit_scene();
  const Prepared s(scene, test::random_particles(scene, 300, 4, 5), 1e-4);
  const ImplicitSystem system(s.scene, s.particles, s.stencils, s.grid, 1e-4);
  const NodeField u = random_field(s.grid.size(), 6), v = random_field(s.grid.size(), 7);
  const NodeField Hu = system.hessian(u), Hv = system.hessian(v);
  // Sums of n rounded terms: √n eps with n = 64·300 is 3e-14.
  EXPECT_NEAR(dot(v, Hu), dot(u, Hv), 1e-13 * norm(u) * norm(Hv));
}

// What a whole solve has to keep is asked of every solver, this one too, in
// verification/tests/solvers and verification/suite.

TEST(Implicit, ReportsTheTrueResidual) {
  Scene scene = implicit_scene();
  scene.integrator.tolerance = 1e-5;
  const double dt = 3e-3;
  const Prepared s(scene, test::random_particles(scene, 200, 4, 15), dt);
  Grid grid = s.grid;
  const IntegrationReport report = integration(s.scene, s.particles, s.stencils, dt, grid);
  const ImplicitSystem system(s.scene, s.particles, s.stencils, grid, dt);
  const NodeField r = minus(grid.v_star, system.apply(grid.v_new));
  const double true_residual =
      std::sqrt(inner_product(grid.m, r, r) / inner_product(grid.m, grid.v_star, grid.v_star));
  EXPECT_DOUBLE_EQ(report.residual, true_residual);
  EXPECT_LE(true_residual, 1e-5);
}

}  // namespace
}  // namespace firn::reference
