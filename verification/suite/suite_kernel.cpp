// SPDX-License-Identifier: BSD-3-Clause
/// The cubic B-spline as a solver's own scatter and gather have it.

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "verification/suite/probes.hpp"

namespace firn::suite {
namespace {

/// Three factors of a few roundings each, their product and the mass.
constexpr double weight_roundings = 16;

Real weight(const LoneParticles& lone, std::size_t p, const NodeIndex& n) {
  const Vec3& x = lone.state.particles.x[p];
  const Real h = lone.scene.grid.spacing;
  return N(x[0] / h - n.i) * N(x[1] / h - n.j) * N(x[2] / h - n.k);
}

/// Relative to each weight, however small: the factored form (2 − |x|)³/6 reaches this, the printed
/// polynomial loses all digits near |x| = 2, and the velocity of a light node with them.
FIRN_TEST(Kernel, weights) {
  FIRN_NEEDS_STOP(Stage::rasterize);
  LoneParticles lone(effort(10, 4));
  fixtures::Random random(2);
  for (Vec3& v : lone.state.particles.v) v = rounded(random.vec3());
  const State state = run_through(lone.scene, lone.state, Stage::rasterize, 1e-4);
  const Grid& grid = state.grid;
  ASSERT_EQ(grid.m.size(), grid.size());
  double worst = 0, worst_v = 0;
  std::string where;
  std::vector<std::size_t> nodes_of(lone.size(), 0);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const std::size_t p = lone.owner(grid.node[i]);
    const Real w = weight(lone, p, grid.node[i]);
    ++nodes_of[p];
    const double error =
        w > 0 ? std::abs(static_cast<double>((grid.m[i] - w) / w)) / (weight_roundings * eps())
              : grid.m[i] / 1e-300;
    if (!(error <= worst)) {
      worst = error;
      where = fmt::format("node ({},{},{}): {:.17g}, exact {:.17g}", grid.node[i].i, grid.node[i].j,
                          grid.node[i].k, grid.m[i], static_cast<double>(w));
    }
    // A node with one particle has its velocity: a product and a quotient.
    worst_v = std::max(worst_v, (grid.v[i] - lone.state.particles.v[p]).norm() / (8 * eps()));
  }
  const auto count = static_cast<std::int64_t>(grid.size());
  within_all("w_ip, relative to itself", count, worst, where);
  within_all("velocity of a node with one particle", 3 * count, worst_v);
  std::int64_t wrong = 0;
  for (std::size_t p = 0; p < lone.size(); ++p) {
    std::size_t expected = 1;
    for (int a = 0; a < 3; ++a) {
      const double X = lone.state.particles.x[p][a] / spacing;
      expected *= X == std::floor(X) ? 3u : 4u;
    }
    wrong += nodes_of[p] != expected ? 1 : 0;
  }
  expect("nodes of positive mass: 64, fewer where a particle lies on a node", wrong == 0,
         fmt::format("{} particles with another number", wrong));
}

FIRN_TEST(Kernel, moments) {
  FIRN_NEEDS_STOP(Stage::rasterize);
  LoneParticles lone(effort(10, 4), 3);
  const State state = run_through(lone.scene, lone.state, Stage::rasterize, 1e-4);
  const std::size_t n = lone.size();
  std::vector<double> zeroth(n, -1.0);
  std::vector<Vec3> first(n, Vec3::Zero());
  std::vector<Mat3> second(n, -Mat3::Identity() / 3);
  for (std::size_t i = 0; i < state.grid.size(); ++i) {
    const std::size_t p = lone.owner(state.grid.node[i]);
    const Vec3 d = (position(lone.scene, state.grid.node[i]) - lone.state.particles.x[p]) / spacing;
    zeroth[p] += state.grid.m[i];
    first[p] += state.grid.m[i] * d;
    second[p] += state.grid.m[i] * d * d.transpose();
  }
  for (std::size_t p = 0; p < n; ++p) {
    // Weights are right to 16 eps of themselves; Σw = 1, Σw|d| ≤ 1.5, Σw|d|² ≤ 2.
    within("Σ w_ip = 1", zeroth[p], weight_roundings * eps());
    within("Σ w_ip (x_i − x_p) = 0", first[p].norm(), 1.5 * weight_roundings * eps());
    within("Σ w_ip (x_i − x_p)(x_i − x_p)ᵀ = h²/3 I", second[p].norm(),
           3 * weight_roundings * eps());
  }
}

/// Step 2: ρ_p0 = Σ_i m_i w_ip/h³, V_p0 = m_p/ρ_p0 where the volume is not known; a known one
/// stays.
FIRN_TEST(Kernel, volumes) {
  FIRN_NEEDS_STOP(Stage::volumes);
  Scene scene = plain_scene();
  State state;
  Particles& p = state.particles;
  fixtures::Random random(9);
  p.resize(static_cast<std::size_t>(effort(400, 100)));
  for (std::size_t q = 0; q < p.size(); ++q) {
    for (int a = 0; a < 3; ++a) p.x[q][a] = spacing * std::floor(2.5 * random() * 4096) / 4096;
    p.m[q] = rounded(1 + 0.5 * random());
    p.V_0[q] = q % 3 == 0 ? rounded(0.01 * (1 + 0.5 * random())) : 0;
    p.id[q] = static_cast<std::int64_t>(q);
  }
  const State after = run_through(scene, state, Stage::volumes, 1e-4);
  const double h = spacing;
  for (std::size_t q = 0; q < p.size(); ++q) {
    if (p.V_0[q] > 0) {
      within("a known volume stays", after.particles.V_0[q] - p.V_0[q], eps() * p.V_0[q]);
      continue;
    }
    double density = 0;
    for_each_weight(scene, after.grid, p.x[q], [&](std::size_t i, double w_ip) {
      density += after.grid.m[i] * w_ip / (h * h * h);
    });
    // 64 positive terms, each right to its weight's roundings.
    within("V_p0 = m_p h³/Σ m_i w_ip", after.particles.V_0[q] * density / p.m[q] - 1,
           2 * weight_roundings * eps());
  }
}

/// An isotropic stress makes f_i = −V τ ∇w_ip: the gradient itself.
FIRN_TEST(Kernel, gradients) {
  FIRN_NEEDS_STOP(Stage::grid_forces);
  LoneParticles lone(effort(10, 4), 4);
  const double s = 1.25;
  for (Mat3& F : lone.state.particles.F_E) F = s * Mat3::Identity();
  const Material& m = lone.scene.materials[0];
  const double J = s * s * s, tau = 2 * m.mu_0() * (s - 1) * s + m.lambda_0() * (J - 1) * J;
  const State state = run_through(lone.scene, lone.state, Stage::grid_forces, 1e-4);
  const double h = spacing, V = h * h * h;
  std::vector<Vec3> sum(lone.size(), Vec3::Zero());
  std::vector<Mat3> first(lone.size(), Mat3::Identity());
  double worst = 0;
  std::string where;
  for (std::size_t i = 0; i < state.grid.size(); ++i) {
    const NodeIndex& n = state.grid.node[i];
    const std::size_t p = lone.owner(n);
    const Vec3& x = lone.state.particles.x[p];
    const Real d[3] = {Real(x[0]) / h - n.i, Real(x[1]) / h - n.j, Real(x[2]) / h - n.k};
    Vec3 grad, scale;
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      grad[a] = static_cast<double>(dN(d[a]) * N(d[b]) * N(d[c]) / h);
      // N' changes its sign at the node: there it is right relative to N. Where the node is
      // light, N is smaller than N' and the gradient right relative to itself.
      scale[a] = static_cast<double>((std::abs(dN(d[a])) + N(d[a])) * N(d[b]) * N(d[c]) / h);
    }
    const Vec3 measured = -state.grid.f[i] / (V * tau);
    // The gradient's products as above, and some 16 roundings of the stress.
    const double error = (measured - grad).norm() / (48 * eps() * scale.norm() + 1e-300);
    if (!(error <= worst)) {
      worst = error;
      where = fmt::format("node ({},{},{})", n.i, n.j, n.k);
    }
    sum[p] += measured;
    first[p] -= measured * (position(lone.scene, n) - x).transpose();
  }
  within_all("∇w_ip, relative to its own size and w_ip/h",
             3 * static_cast<std::int64_t>(state.grid.size()), worst, where);
  for (std::size_t p = 0; p < lone.size(); ++p) {
    // Σ|∇w| ≤ 3/h and Σ|∇w||x_i − x_p| ≤ 4: as many roundings of each term.
    within("Σ ∇w_ip = 0", sum[p].norm(), 48 * 3 / h * eps());
    // Its sign is that of a gradient with respect to x_p, and it is 1 only if 1/h is there.
    within("Σ ∇w_ip (x_i − x_p)ᵀ = I", (first[p]).norm(), 48 * 4 * eps());
  }
}

/// Linear fields on the grid are gathered exactly, quadratic ones with the second moment.
FIRN_TEST(Kernel, gathered_fields) {
  FIRN_NEEDS_STOP(Stage::integration);
  FIRN_NEEDS_STOP(Stage::particle_velocities);
  LoneParticles lone(effort(8, 3), 5);
  lone.scene.flip = 0.75;
  fixtures::Random random(6);
  const double dt = 0x1p-10;
  for (std::size_t p = 0; p < lone.size(); ++p) lone.state.particles.v[p] = rounded(random.vec3());
  State state = before_stage(lone.scene, lone.state, Stage::deformation, dt);
  const Mat3 B = rounded(random.mat3()), D = rounded(random.mat3());
  const Vec3 a = rounded(random.vec3());
  Vec3 q = rounded(random.vec3());
  double largest = 0;
  for (std::size_t i = 0; i < state.grid.size(); ++i) {
    const Vec3 x = position(lone.scene, state.grid.node[i]);
    state.grid.v_new[i] = rounded(Vec3(a + B * x + q.cwiseProduct(x.cwiseAbs2())));
    state.grid.v[i] = rounded(Vec3(D * x));
    largest = std::max({largest, state.grid.v_new[i].norm(), state.grid.v[i].norm()});
  }
  const State after = run_through(lone.scene, state, Stage::particle_velocities, dt);
  const double h = spacing;
  for (std::size_t p = 0; p < lone.size(); ++p) {
    const Vec3& x = lone.state.particles.x[p];
    const Vec3 PIC = a + B * x + q.cwiseProduct(x.cwiseAbs2() + Vec3::Constant(h * h / 3));
    const Vec3 FLIP = lone.state.particles.v[p] + PIC - D * x;
    const Vec3 v = 0.25 * PIC + 0.75 * FLIP;
    // 64 terms w v, whose sum keeps the weights' 16 roundings of the largest |v|; three such sums.
    within("v_p from linear and quadratic fields", (after.particles.v[p] - v).norm(),
           3 * weight_roundings * eps() * (largest + 1));
    // d(x²)/dx of the spline's interpolation is 2x; Σ|v||∇w| ≤ 3/h times the largest |v|.
    Mat3 L = B;
    L.diagonal() += 2 * q.cwiseProduct(x);
    within("∇v_p from linear and quadratic fields",
           (after.particles.F_E[p] - Mat3::Identity() - dt * L).norm(),
           (48 * 3 / h * dt * largest + 8) * eps());
  }
}

/// 10 000 cells from the origin, where a position in float has 9 bits for the place in its cell.
FIRN_TEST(Kernel, far_from_the_origin) {
  FIRN_NEEDS_STOP(Stage::rasterize);
  Scene scene = plain_scene();
  State state;
  state.particles.resize(1);
  Particles& p = state.particles;
  p.x[0] = spacing * Vec3(10000 + 77 * 0x1p-9, -10000 - 200 * 0x1p-9, 0.3125);
  p.m[0] = 1;
  const State after = run_through(scene, state, Stage::rasterize, 1e-4);
  double worst = 0;
  for (std::size_t i = 0; i < after.grid.size(); ++i) {
    const NodeIndex& n = after.grid.node[i];
    const Real w = N(Real(p.x[0][0]) / spacing - n.i) * N(Real(p.x[0][1]) / spacing - n.j) *
                   N(Real(p.x[0][2]) / spacing - n.k);
    worst = std::max(worst, std::abs(static_cast<double>((after.grid.m[i] - w) / w)));
  }
  expect("64 nodes", after.grid.size() == 64);
  // The position is exact in every precision, and so is its place in the cell for whoever keeps
  // it apart from the cell's number.
  within("w_ip, relative to itself", worst, weight_roundings * eps());
}

/// A grid whose origin is not zero, and a particle whose nodes lie on both sides of a seam.
FIRN_TEST(Kernel, origin_and_seam) {
  FIRN_NEEDS_STOP(Stage::rasterize);
  Scene scene = plain_scene();
  scene.grid.origin = spacing * Vec3(0.25, -0.375, 0.5);
  scene.grid.periodic = spacing * Vec3(6, 0, 0);
  State state;
  state.particles.resize(1);
  state.particles.x[0] = scene.grid.origin + spacing * Vec3(0.125, -3.25, 2.625);
  state.particles.m[0] = 1;
  const State after = run_through(scene, state, Stage::rasterize, 1e-4);
  std::int64_t met = 0;
  for_each_weight(scene, after.grid, state.particles.x[0], [&](std::size_t i, double w_ip) {
    ++met;
    within("w_ip", after.grid.m[i] - w_ip, weight_roundings * eps() * w_ip);
  });
  expect("the 64 nodes are where they should be", met == 64 && after.grid.size() == 64);
}

/// A whole step of a lone, deformed particle, for solvers that stop nowhere else as well:
/// F' = (I − (Δt²V/m) τ diag(Σ N'²/N)/h²) F, v and x move on.
FIRN_TEST(Kernel, one_step_of_a_lone_particle) {
  LoneParticles lone(effort(6, 3), 7);
  fixtures::Random random(8);
  Particles& p = lone.state.particles;
  const double dt = 0x1p-12, h = spacing;
  for (std::size_t q = 0; q < lone.size(); ++q) {
    p.v[q] = rounded(random.vec3());
    p.F_E[q] = rounded(Mat3(Mat3::Identity() + 0.2 * random.mat3()));
  }
  const State after = run_steps(lone.scene, lone.state, 1, dt);
  const Material& m = lone.scene.materials[0];
  for (std::size_t q = 0; q < lone.size(); ++q) {
    const Matrix F = to_matrix(p.F_E[q]), R = verification::polar_oracle(F);
    const Real J = verification::det(F);
    Mat3 tau = 2 * m.mu_0() * (p.F_E[q] - to_mat3(R)) * p.F_E[q].transpose();
    tau += static_cast<double>(m.lambda_0() * (J - 1) * J) * Mat3::Identity();
    Mat3 L;
    double stiffest = 0;
    for (int a = 0; a < 3; ++a) {
      const Real X = Real(p.x[q][a]) / h;
      Real sum = 0;
      for (Real n = std::floor(X) - 1; n < std::floor(X) + 3; ++n)
        if (N(X - n) > 0) sum += dN(X - n) * dN(X - n) / N(X - n);
      L.col(a) = -dt * dt * p.V_0[q] / p.m[q] * tau.col(a) * static_cast<double>(sum) / (h * h);
      stiffest = std::max(stiffest, static_cast<double>(sum));
    }
    const double factor = dt * dt * p.V_0[q] / p.m[q] * stiffest / (h * h);
    within("F of a lone particle",
           (after.particles.F_E[q] - (Mat3::Identity() + L) * p.F_E[q]).norm(),
           factor * stress_roundoff(m, p.F_E[q], p.F_P[q]) + (48 * 3 / h * dt * 2 + 16) * eps());
    // Σ f_i = 0: its own stress does not move a particle. Some 64 roundings of Δt f/m.
    const double kick = dt * p.V_0[q] / p.m[q] * tau.norm() * 3 / h;
    within("v_p of a lone particle", (after.particles.v[q] - p.v[q]).norm(),
           48 * eps() * (2 + kick));
    within("x_p of a lone particle", (after.particles.x[q] - p.x[q] - dt * p.v[q]).norm(),
           4 * eps() * (4 * h + (in_float() ? 0 : p.x[q].norm())) + 48 * eps() * dt * (2 + kick));
  }
}

}  // namespace
}  // namespace firn::suite
