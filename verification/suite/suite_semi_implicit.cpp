// SPDX-License-Identifier: BSD-3-Clause
/// The semi-implicit solve, judged without knowing how it is done.

#include <Eigen/Dense>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "firn/diagnostics.hpp"
#include "firn/error.hpp"
#include "verification/oracles/elastic_oracle.hpp"
#include "verification/suite/probes.hpp"

namespace firn::suite {
namespace {

#define FIRN_NEEDS_SOLVE() \
  if (!solves_implicitly()) GTEST_SKIP() << "the solver takes explicit scenes only"

/// The residual that a solver of this precision can be asked for.
double tight() { return in_float() ? 1e-5 : 1e-11; }

Scene implicit_scene(double beta) {
  Scene scene = plain_scene();
  scene.materials = {Material{}};
  scene.materials[0].name = "snow";
  scene.integrator.type = IntegratorType::semi_implicit;
  scene.integrator.implicitness = beta;
  scene.integrator.tolerance = tight();
  return scene;
}

State random_snow(std::size_t n, double cells, std::uint64_t seed) {
  State state = rounded_snow(n, cells, seed, {.plastic_strain = 0.03});
  Particles& p = state.particles;
  for (std::size_t q = 0; q < n; ++q) p.V_0[q] = rounded(p.m[q] / 400);
  return state;
}

Totals momentum_of(const State& state) { return totals(state.particles); }

FIRN_TEST(SemiImplicit, beta_zero_is_explicit) {
  FIRN_NEEDS_SOLVE();
  Scene scene = implicit_scene(0);
  const State initial = random_snow(static_cast<std::size_t>(effort(200, 60)), 4, 61);
  const State a = run_steps(scene, initial, 3, 0x1p-14);
  scene.integrator.type = IntegratorType::explicit_euler;
  const State b = run_steps(scene, initial, 3, 0x1p-14);
  for (std::size_t q = 0; q < initial.particles.size(); ++q) {
    // The same formula, perhaps by another path: some roundings per step.
    within("v_p", (a.particles.v[q] - b.particles.v[q]).norm(), 256 * eps() * 3);
    within("F_E", (a.particles.F_E[q] - b.particles.F_E[q]).norm(), 256 * eps());
  }
}

/// β = 1 against explicit after one step: their difference is Δt² H v.
FIRN_TEST(SemiImplicit, differs_from_explicit_by_second_order) {
  FIRN_NEEDS_SOLVE();
  const State initial = random_snow(static_cast<std::size_t>(effort(100, 40)), 3, 62);
  Scene implicit = implicit_scene(1), plain = implicit;
  plain.integrator.type = IntegratorType::explicit_euler;
  const auto difference = [&](double dt) {
    const State a = run_steps(implicit, initial, 1, dt), b = run_steps(plain, initial, 1, dt);
    double sum = 0;
    for (std::size_t q = 0; q < initial.particles.size(); ++q)
      sum += (a.particles.v[q] - b.particles.v[q]).squaredNorm();
    return std::sqrt(sum);
  };
  const double dt = in_float() ? 0x1p-13 : 0x1p-17;
  const double ratio = difference(2 * dt) / difference(dt);
  // The next term is Δt²‖M⁻¹H‖ of this one: (cΔt/h)² = 2e-5 in double, 5e-3 times some 10 in float.
  within("ratio of the differences at 2Δt and Δt is 4", ratio - 4, in_float() ? 0.5 : 0.05);
}

/// e'/e = (1 + (β − 1)z²)/(1 + βz²), z² = Δt²(V/m) S (2μ + 3λ)/h², S = ΣN'²/N along an axis.
FIRN_TEST(SemiImplicit, single_particle_factor) {
  FIRN_NEEDS_SOLVE();
  const double e = in_float() ? 0x1p-11 : 0x1p-26, h = spacing, dt = 0x1p-10;
  for (const double beta : {0.25, 0.5, 1.0}) {
    Scene scene = implicit_scene(beta);
    State state;
    state.particles.resize(1);
    Particles& p = state.particles;
    const double s = 0.3125;
    p.x[0] = h * Vec3::Constant(s);
    p.V_0[0] = h * h * h;
    p.m[0] = 400 * h * h * h;
    p.F_E[0] = (1 + e) * Mat3::Identity();
    Real S = 0;
    for (int n = -1; n <= 2; ++n) S += dN(Real(s) - n) * dN(Real(s) - n) / N(Real(s) - n);
    const Material& m = scene.materials[0];
    const double z2 =
        dt * dt / 400 * static_cast<double>(S) * (2 * m.mu_0() + 3 * m.lambda_0()) / (h * h);
    const State after = run_steps(scene, state, 1, dt);
    const double measured = (after.particles.F_E[0](0, 0) - 1) / e;
    // e is known to eps/e where F is stored; linearization and change of volume add terms of size
    // e.
    within(fmt::format("e'/e, beta = {}", beta), measured - (1 + (beta - 1) * z2) / (1 + beta * z2),
           8 * (eps() / e + 4 * e) + 10 * tight());
  }
}

FIRN_TEST(SemiImplicit, momentum_at_any_tolerance) {
  FIRN_NEEDS_SOLVE();
  const State initial = random_snow(static_cast<std::size_t>(effort(600, 100)), 5, 63);
  for (const double tolerance : {1e-1, 1e-3, tight()}) {
    Scene scene = implicit_scene(1);
    scene.integrator.tolerance = tolerance;
    const State after = run_steps(scene, initial, 2, 0x1p-9);
    const Totals a = momentum_of(initial), b = momentum_of(after);
    within(fmt::format("momentum at tolerance {:.0e}", tolerance), (b.momentum - a.momentum).norm(),
           450 * eps() * (a.momentum_scale + b.momentum_scale));
  }
}

FIRN_TEST(SemiImplicit, residual_is_what_was_asked_for) {
  FIRN_NEEDS_SOLVE();
  FIRN_NEEDS_STOP(Stage::integration);
  const State initial = random_snow(static_cast<std::size_t>(effort(300, 60)), 4, 64);
  for (const double tolerance : {1e-2, 1e-4, tight()}) {
    Scene scene = implicit_scene(1);
    scene.integrator.tolerance = tolerance;
    StepReport report;
    run_through(scene, initial, Stage::integration, 0x1p-9, &report);
    within(fmt::format("reported residual, tolerance {:.0e}", tolerance), report.solver_residual,
           tolerance);
    expect("iterations were made", report.solver_iterations > 0);
  }
}

/// P F_Eᵀ(old) of F̂_E = (I + L) F_E in extended precision.
Mat3 stress_at(const Material& m, const Mat3& F_E, const Mat3& F_P, const Matrix& L, Real by) {
  Matrix grown = L;
  for (Real& x : grown) x *= by;
  for (const std::size_t k : {0u, 4u, 8u}) grown[k] += 1;
  const Matrix F0 = to_matrix(F_E), F = verification::multiply(grown, F0);
  const Real hard = std::exp(m.hardening * (1 - verification::det(to_matrix(F_P))));
  const Matrix R = verification::polar_oracle(F);
  const Real J = verification::det(F), mu = m.mu_0() * hard, lambda = m.lambda_0() * hard;
  Matrix P;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      const Real cofactor = F[3 * a + c] * F[3 * b + d] - F[3 * a + d] * F[3 * b + c];
      P[3 * i + j] = 2 * mu * (F[3 * i + j] - R[3 * i + j]) + lambda * (J - 1) * cofactor;
    }
  return to_mat3(verification::multiply(P, verification::transpose(F0)));
}

/// v_i^{n+1} against LU of the assembled matrix, H by differences of the forces: neither the
/// formula for δP nor an iteration is used.
FIRN_TEST(SemiImplicit, direct_solve) {
  FIRN_NEEDS_SOLVE();
  FIRN_NEEDS_STOP(Stage::grid_collisions);
  FIRN_NEEDS_STOP(Stage::integration);
  Scene scene = implicit_scene(0.75);
  Collider rough, sticky;
  rough.shape = HalfSpace{Vec3(0, 0, -0.51 * spacing), Vec3(0.1, 0, 1)};
  rough.friction = 0.4;
  sticky.shape = HalfSpace{Vec3(0, 0.61 * spacing, 0), Vec3(0, -1, 0)};
  sticky.sticky = true;
  scene.colliders = {rough, sticky};
  const double dt = 0x1p-10;
  const State initial = random_snow(10, 1, 65);
  const State state = run_through(scene, initial, Stage::grid_collisions, dt);
  const Grid& grid = state.grid;
  const auto nodes = static_cast<Eigen::Index>(grid.size()), n = 3 * nodes;
  ASSERT_EQ(grid.free_directions.size(), grid.size());
  const Particles& p = state.particles;
  // ∇w_ip, in extended precision.
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t q = 0; q < p.size(); ++q) {
    std::vector<std::pair<Eigen::Index, Vec3>> gradients;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const NodeIndex& at = grid.node[i];
      const Real h = spacing,
                 X[3] = {p.x[q][0] / h - at.i, p.x[q][1] / h - at.j, p.x[q][2] / h - at.k};
      const Vec3 g(static_cast<double>(dN(X[0]) * N(X[1]) * N(X[2]) / h),
                   static_cast<double>(N(X[0]) * dN(X[1]) * N(X[2]) / h),
                   static_cast<double>(N(X[0]) * N(X[1]) * dN(X[2]) / h));
      if (g.norm() > 0) gradients.emplace_back(static_cast<Eigen::Index>(i), g);
    }
    // d(P F_Eᵀ)/dL for the nine unit L, then (H u)_i = Σ_p V_p0 (dP F_Eᵀ) ∇w_ip.
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) {
        Matrix L{};
        L[static_cast<std::size_t>(3 * row + column)] = 1;
        const Real step = 1e-4L;
        const auto at = [&](Real by) {
          return stress_at(scene.materials[0], p.F_E[q], p.F_P[q], L, by);
        };
        const Mat3 dP = (8 * (at(step) - at(-step)) - (at(2 * step) - at(-2 * step))) / (12e-4);
        for (const auto& [j, grad_j] : gradients)
          for (const auto& [i, grad_i] : gradients)
            H.block<3, 1>(3 * i, 3 * j + row) += p.V_0[q] * dP * grad_i * grad_j[column];
      }
  }
  within("H is symmetric", (H - H.transpose()).norm(), 1e-9 * H.norm());
  Eigen::MatrixXd B = Eigen::MatrixXd::Identity(n, n), P = Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd v_star(n);
  for (Eigen::Index i = 0; i < nodes; ++i) {
    const auto at = static_cast<std::size_t>(i);
    B.middleRows(3 * i, 3) += 0.75 * dt * dt / grid.m[at] * H.middleRows(3 * i, 3);
    P.block<3, 3>(3 * i, 3 * i) = grid.free_directions[at];
    v_star.segment<3>(3 * i) = grid.v_star[at];
  }
  const Eigen::MatrixXd held = Eigen::MatrixXd::Identity(n, n) - P;
  const Eigen::VectorXd exact =
      v_star + P * (P * B * P + held).partialPivLu().solve(P * (v_star - B * v_star));
  const State after = run_through(scene, state, Stage::integration, dt);
  double error = 0, size = 0, change = 0;
  for (Eigen::Index i = 0; i < nodes; ++i) {
    const auto at = static_cast<std::size_t>(i);
    error += grid.m[at] * (after.grid.v_new[at] - exact.segment<3>(3 * i)).squaredNorm();
    change += grid.m[at] * (grid.v_star[at] - exact.segment<3>(3 * i)).squaredNorm();
    size += grid.m[at] * grid.v_star[at].squaredNorm();
    if (grid.free_directions[at].isZero(0))
      within("a node that sticks keeps v*", (after.grid.v_new[at] - grid.v_star[at]).norm(),
             8 * eps() * (1 + grid.v_star[at].norm()));
  }
  // The residual in the mass norm bounds the error: no eigenvalue of B is below about 1. The
  // differences leave 1e-12 of the change.
  within("v_i^{n+1} against LU", std::sqrt(error / size), 4 * tight() + 64 * eps() + 1e-11);
  expect("the solve had something to do", std::sqrt(change / size) > 0.01);
}

/// A block falls onto the ground with steps of 20 h/c: no node of the contact moves inwards.
FIRN_TEST(SemiImplicit, contact_is_held) {
  FIRN_NEEDS_SOLVE();
  FIRN_NEEDS_STOP(Stage::integration);
  Scene scene = implicit_scene(1);
  scene.integrator.tolerance = in_float() ? 1e-4 : 1e-8;
  Collider ground;
  ground.shape = HalfSpace{Vec3(0, 0, -0.3 * spacing), Vec3::UnitZ()};
  ground.friction = 0.2;
  scene.colliders = {ground};
  State state = random_snow(static_cast<std::size_t>(effort(300, 60)), 4, 66);
  for (Vec3& x : state.particles.x) x[2] += 2 * spacing;
  for (Vec3& v : state.particles.v) v = rounded(Vec3(0.2 * v[0], 0.2 * v[1], -1 + 0.2 * v[2]));
  const double dt = 0x1p-10 * 50;
  const State after = run_through(scene, state, Stage::integration, dt);
  double inward = 0, largest = 0;
  std::int64_t contacts = 0;
  for (std::size_t i = 0; i < after.grid.size(); ++i) {
    largest = std::max(largest, after.grid.v_new[i].norm());
    if (ground.phi(position(scene, after.grid.node[i]), 0) > 0) continue;
    // What left the ground before the solve is free.
    if (after.grid.free_directions[i].isIdentity(0)) continue;
    ++contacts;
    inward = std::max(inward, -after.grid.v_new[i][2]);
  }
  within("inward speed of nodes in contact", inward, 64 * eps() * (1 + largest));
  expect("nodes are in contact", contacts > 10);
}

/// A block compressed by 1 % and let go with Δt = 100 h/c: never more energy than at the start.
FIRN_TEST(SemiImplicit, energy_at_large_steps) {
  FIRN_NEEDS_SOLVE();
  Scene scene = implicit_scene(1);
  scene.materials[0] = elastic_material();
  scene.integrator.tolerance = in_float() ? 1e-4 : 1e-8;
  scene.integrator.max_iterations = 2000;
  State state;
  const int edge = effort(8, 4);
  std::vector<Vec3> x;
  for (int i = 0; i < edge; ++i)
    for (int j = 0; j < edge; ++j)
      for (int k = 0; k < edge; ++k) x.push_back(0.5 * spacing * Vec3(i + 0.5, j + 0.5, k + 0.5));
  Particles& p = state.particles;
  p.resize(x.size());
  p.x = x;
  for (std::size_t q = 0; q < x.size(); ++q) {
    p.V_0[q] = spacing * spacing * spacing / 8;
    p.m[q] = 400 * p.V_0[q];
    p.F_E[q] = rounded(Mat3(0.99 * Mat3::Identity()));
    p.id[q] = static_cast<std::int64_t>(q);
  }
  const double E_0 = measure(scene, state).elastic_energy;
  const auto solver = make_subject();
  solver->load(scene, state);
  for (int n = 0; n < effort(10, 3); ++n) {
    solver->step(100 * spacing / 20);
    solver->store(state);
    const Diagnostics d = measure(scene, state);
    within("energy above the initial", std::max(0.0, d.elastic_energy + d.kinetic_energy - E_0),
           450 * eps() * E_0);
  }
}

/// Strong isotropic compression makes the matrix indefinite: solved to the tolerance all the
/// same, or an error that says so; never a wrong answer in silence.
FIRN_TEST(SemiImplicit, indefinite_systems) {
  FIRN_NEEDS_SOLVE();
  FIRN_NEEDS_STOP(Stage::integration);
  Scene scene = implicit_scene(1);
  scene.integrator.tolerance = in_float() ? 1e-3 : 1e-8;
  scene.integrator.max_iterations = 5000;
  State state = random_snow(60, 3, 67);
  for (Mat3& F : state.particles.F_E) F = rounded(Mat3(0.8 * Mat3::Identity()));
  for (Mat3& F : state.particles.F_P) F.setIdentity();
  try {
    StepReport report;
    const State after = run_through(scene, state, Stage::integration, 0x1p-6, &report);
    within("residual", report.solver_residual, scene.integrator.tolerance);
    bool finite = true;
    for (const Vec3& v : after.grid.v_new) finite = finite && v.allFinite();
    expect("finite, or an error", finite);
  } catch (const SimulationError& error) {
    expect("finite, or an error", error.stage() == Stage::integration, error.what());
  }
}

}  // namespace
}  // namespace firn::suite
