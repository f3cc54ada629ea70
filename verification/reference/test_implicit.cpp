#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <Eigen/SVD>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "firn/error.hpp"
#include "reference/implicit_system.hpp"
#include "reference/steps.hpp"
#include "verification/reference/scenes.hpp"

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

Eigen::VectorXd flat(const NodeField& u) {
  Eigen::VectorXd x(3 * static_cast<Eigen::Index>(u.size()));
  for (std::size_t i = 0; i < u.size(); ++i) x.segment<3>(3 * static_cast<Eigen::Index>(i)) = u[i];
  return x;
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

/// A whole step 6 against the assembled matrix and Eigen's LU. Nodes that are
/// held keep v*: their rows of the projected matrix are P, their right side 0.
void compare_with_direct_solve(const Prepared& s, double dt) {
  Grid grid = s.grid;
  const IntegrationReport report = integration(s.scene, s.particles, s.stencils, dt, grid);
  EXPECT_LE(report.residual, s.scene.integrator.tolerance);
  EXPECT_GT(report.iterations, 0);

  const ImplicitSystem system(s.scene, s.particles, s.stencils, s.grid, dt);
  const auto n = static_cast<Eigen::Index>(3 * grid.size());
  Eigen::MatrixXd B(n, n), P = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    NodeField e(grid.size(), Vec3::Zero());
    e[static_cast<std::size_t>(j / 3)][j % 3] = 1;
    B.col(j) = flat(system.apply(e));
  }
  for (std::size_t i = 0; i < grid.size(); ++i)
    P.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(i)) =
        grid.free_directions[i];
  const Eigen::VectorXd v_star = flat(grid.v_star);
  const Eigen::MatrixXd held = Eigen::MatrixXd::Identity(n, n) - P;
  const Eigen::VectorXd d = (P * B * P + held).partialPivLu().solve(P * (v_star - B * v_star));
  const Eigen::VectorXd expected = v_star + P * d;
  // A relative residual of 1e-12 in the kinetic norm; lighter nodes see it divided by the square
  // root of their share of the mass, and the matrix's smallest eigenvalue is about 1.
  EXPECT_LE((flat(grid.v_new) - expected).lpNorm<Eigen::Infinity>(),
            1e-7 * v_star.lpNorm<Eigen::Infinity>());
  const Eigen::VectorXd mass_weighted = (flat(grid.v_new) - expected);
  double error = 0, size = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    error += grid.m[i] * mass_weighted.segment<3>(3 * static_cast<Eigen::Index>(i)).squaredNorm();
    size += grid.m[i] * grid.v_star[i].squaredNorm();
  }
  EXPECT_LE(std::sqrt(error / size), 1e-11);
}

TEST(Implicit, AgreesWithADirectSolve) {
  const Scene scene = implicit_scene();
  const double dt = 2e-3;
  compare_with_direct_solve(Prepared(scene, test::random_particles(scene, 60, 3, 8), dt), dt);
}

TEST(Implicit, AgreesWithADirectSolveWhereNodesAreHeld) {
  Scene scene = implicit_scene();
  Collider rough, smooth, sticky;
  rough.shape = HalfSpace{Vec3(0, 0, -0.051), Vec3(0.1, 0, 1)};
  rough.friction = 0.4;
  smooth.shape = HalfSpace{Vec3(-0.051, 0, 0), Vec3(1, 0.2, 0.3)};
  sticky.shape = HalfSpace{Vec3(0, 0.13, 0), Vec3(0, -1, 0)};
  sticky.sticky = true;
  scene.colliders = {rough, smooth, sticky};
  const double dt = 2e-3;
  const Prepared s(scene, test::random_particles(scene, 60, 3, 9), dt);
  std::array<int, 4> free_dimensions{};
  for (std::size_t i = 0; i < s.grid.size(); ++i)
    ++free_dimensions[static_cast<std::size_t>(std::lround(s.grid.free_directions[i].trace()))];
  for (const int nodes : free_dimensions) EXPECT_GT(nodes, 0);  // every kind of node is there
  compare_with_direct_solve(s, dt);

  // Held nodes hold: along the directions that are not free v_new equals v*, to the roundoff of
  // a projection, and exactly where nothing is free.
  Grid grid = s.grid;
  integration(s.scene, s.particles, s.stencils, dt, grid);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Mat3& P = grid.free_directions[i];
    const Vec3 change = grid.v_new[i] - grid.v_star[i];
    if (P.isZero(0)) {
      EXPECT_EQ(change, Vec3(Vec3::Zero()));
    }
    EXPECT_LE((change - P * change).norm(), 1e-14 * (1 + grid.v_star[i].norm()));
  }
}

TEST(Implicit, BetaZeroIsExplicitToTheLastBit) {
  Scene scene = implicit_scene(0);
  const State initial = test::random_particles(scene, 200, 4, 10);
  auto implicit = test::make_reference();
  implicit->load(scene, initial);
  Scene explicit_scene = scene;
  explicit_scene.integrator.type = IntegratorType::explicit_euler;
  auto plain = test::make_reference();
  plain->load(explicit_scene, initial);
  State a, b;
  for (int step = 0; step < 3; ++step) {
    implicit->step(1e-4);
    plain->step(1e-4);
  }
  implicit->store(a);
  plain->store(b);
  EXPECT_EQ(a.particles.x, b.particles.x);
  EXPECT_EQ(a.particles.v, b.particles.v);
  EXPECT_EQ(a.particles.F_E, b.particles.F_E);
  EXPECT_EQ(a.particles.F_P, b.particles.F_P);
}

TEST(Implicit, OneStepDiffersFromExplicitBySecondOrder) {
  const Scene scene = implicit_scene();
  const State initial = test::random_particles(scene, 100, 3, 11);
  const auto difference = [&](double dt) {
    const Prepared s(scene, initial, dt);
    Grid grid = s.grid;
    integration(s.scene, s.particles, s.stencils, dt, grid);
    return std::sqrt(
        inner_product(grid.m, minus(grid.v_new, grid.v_star), minus(grid.v_new, grid.v_star)));
  };
  const double ratio = difference(2e-5) / difference(1e-5);
  EXPECT_NEAR(ratio, 4, 0.05);  // Δt² with a next term of relative size Δt²‖M⁻¹H‖ ~ 1e-2
}

TEST(Implicit, MomentumIsExactAtAnyTolerance) {
  for (const double tolerance : {1e-1, 1e-3, 1e-10}) {
    Scene scene = implicit_scene();
    scene.integrator.tolerance = tolerance;
    const double dt = 5e-3;
    const Prepared s(scene, test::random_particles(scene, 1000, 6, 12), dt);
    Grid grid = s.grid;
    const IntegrationReport report = integration(s.scene, s.particles, s.stencils, dt, grid);
    EXPECT_GT(report.iterations, 0);
    Vec3 before = Vec3::Zero(), after = Vec3::Zero();
    double scale = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      before += grid.m[i] * grid.v_star[i];
      after += grid.m[i] * grid.v_new[i];
      scale += grid.m[i] * grid.v_star[i].norm();
    }
    EXPECT_LE((after - before).norm(), 1e-13 * scale) << "tolerance " << tolerance;
  }
}

/// One particle, F_E = (1 + e) I, at rest: e' / e = (1 + (β − 1) z²)/(1 + βz²),
/// z² = Δt² (V/m) S (2μ + 3λ)/h², S = Σ N'²/N along an axis.
TEST(Implicit, SingleParticleFactor) {
  for (const double beta : {0.25, 0.5, 1.0}) {
    Scene scene = implicit_scene(beta);
    const Material& material = scene.materials[0];
    State state = test::particles_at_rest(scene);
    const double h = scene.grid.spacing, e = 1e-8;
    state.particles.x[0] = h * Vec3::Constant(0.3);
    state.particles.V_0[0] = h * h * h;
    state.particles.m[0] = material.density * h * h * h;
    state.particles.F_E[0] = (1 + e) * Mat3::Identity();
    // At s = 0.3: N = .7³/6, 2/3 − s² + s³/2, the same for 1 − s, .3³/6
    const double s = 0.3, t = 0.7;
    const double N[4] = {t * t * t / 6, 2. / 3 - s * s + s * s * s / 2,
                         2. / 3 - t * t + t * t * t / 2, s * s * s / 6};
    const double dN[4] = {-t * t / 2, -2 * s + 1.5 * s * s, 2 * t - 1.5 * t * t, s * s / 2};
    double S = 0;
    for (int a = 0; a < 4; ++a) S += dN[a] * dN[a] / N[a];
    const double dt = 1e-3;
    const double z2 =
        dt * dt / material.density * S * (2 * material.mu_0() + 3 * material.lambda_0()) / (h * h);
    auto solver = test::make_reference();
    solver->load(scene, state);
    solver->step(dt);
    solver->store(state);
    const double e_new = state.particles.F_E[0](0, 0) - 1;
    // e is known to eps/e = 2e-8; linearization and volume changes add terms of size e.
    EXPECT_NEAR(e_new / e, (1 + (beta - 1) * z2) / (1 + beta * z2), 5e-7) << "beta " << beta;
  }
}

/// A block compressed by 1 % and let go, with steps of 100 times h/c: never more
/// energy than at the beginning.
TEST(Implicit, CompressedBlockLosesEnergyAtLargeSteps) {
  Scene scene = implicit_scene();
  scene.integrator.tolerance = 1e-8;
  scene.materials[0].critical_compression = scene.materials[0].critical_stretch =
      std::numeric_limits<double>::infinity();
  const double h = scene.grid.spacing;
  State state;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      for (int k = 0; k < 8; ++k) {
        Particles one;
        one.resize(1);
        one.x[0] = 0.5 * h * Vec3(i + 0.5, j + 0.5, k + 0.5);
        one.V_0[0] = h * h * h / 8;
        one.m[0] = 400 * one.V_0[0];
        one.F_E[0] = 0.99 * Mat3::Identity();
        state.particles.append(one);
      }
  const Material& material = scene.materials[0];
  const double c = std::sqrt((material.lambda_0() + 2 * material.mu_0()) / material.density);
  auto solver = test::make_reference();
  solver->load(scene, state);
  const double E_0 = solver->diagnostics().elastic_energy;
  EXPECT_GT(E_0, 0);
  for (int step = 0; step < 10; ++step) {
    solver->step(100 * h / c);
    const Diagnostics d = solver->diagnostics();
    EXPECT_LE(d.elastic_energy + d.kinetic_energy, E_0) << "step " << step;
  }
}

/// Strong isotropic compression: the twist eigenvalue 2μ(1 − 2/(σ_i+σ_j)) + λ(J−1)J/(σ_iσ_j)
/// is negative, and with a large step so is the matrix. Solved all the same, and reported.
TEST(Implicit, IndefiniteSystemsAreSolvedAndReported) {
  Scene scene = implicit_scene();
  scene.integrator.tolerance = 1e-8;
  scene.integrator.max_iterations = 5000;  // eigenvalues of both signs: slow
  State state = test::random_particles(scene, 60, 3, 13);
  for (Mat3& F : state.particles.F_E) F = 0.8 * Mat3::Identity();
  for (Mat3& F : state.particles.F_P) F.setIdentity();
  const double dt = 2e-2;
  const Prepared s(scene, state, dt);
  Grid grid = s.grid;
  const IntegrationReport report = integration(s.scene, s.particles, s.stencils, dt, grid);
  EXPECT_TRUE(report.indefinite);
  EXPECT_LE(report.residual, 1e-8);

  const Prepared calm(scene, test::random_particles(scene, 60, 3, 13), 1e-4);
  grid = calm.grid;
  EXPECT_FALSE(integration(calm.scene, calm.particles, calm.stencils, 1e-4, grid).indefinite);
}

TEST(Implicit, NotConvergedIsAnErrorOfTheSolver) {
  Scene scene = implicit_scene();
  scene.integrator.max_iterations = 3;
  auto solver = test::make_reference();
  const State initial = test::random_particles(scene, 100, 3, 14);
  solver->load(scene, initial);
  try {
    solver->step(1e-2);
    FAIL() << "converged in 3 iterations";
  } catch (const SimulationError& error) {
    EXPECT_EQ(error.stage(), Stage::integration);
    EXPECT_EQ(error.subject(), SimulationError::Subject::solver);
    EXPECT_TRUE(error.state_intact);
  }
  State after;
  solver->store(after);
  EXPECT_EQ(after.particles.v, initial.particles.v);
  EXPECT_EQ(after.particles.V_0, initial.particles.V_0);
}

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
