// SPDX-License-Identifier: BSD-3-Clause
#include "verification/oracles/exact/exact.hpp"

#include <cmath>

#include "verification/oracles/exact/exact_parts.hpp"

namespace firn::exact {

namespace parts {

double sound_speed(const Material& m) {
  return std::sqrt((m.lambda_0() + 2 * m.mu_0()) / m.density);
}

Scene elastic_scene(const std::string& name, double h, double dt, double alpha) {
  Scene scene = fixtures::elastic_scene(name, h, dt);
  scene.flip = alpha;
  return scene;
}

void fill(ExactProblem& problem, int cells_x, int cells_y, int cells_z) {
  problem.initial = fixtures::lattice_block(problem.scene, {cells_x, cells_y, cells_z});
  problem.X = problem.initial.particles.x;
}

}  // namespace parts

using namespace parts;

namespace {

constexpr double two_pi = 2 * M_PI;

}  // namespace

double AlphaPolicy::alpha(double dt) const {
  if (!per_time) return value;
  const double period = 1 / sound_speed(elastic_material());
  return std::max(0.0, 1 - dt / (damping_time_share * period));
}

double ExactProblem::relative_error(const State& state) const {
  double error = 0, size = 0;
  for (std::size_t p = 0; p < X.size(); ++p) {
    const Vec3 u = displacement(X[p], state.time);
    Vec3 off = state.particles.x[p] - X[p] - u;
    for (int axis = 0; axis < 3; ++axis)
      if (const double period = scene.grid.periodic[axis]; period > 0)
        off[axis] -= period * std::round(off[axis] / period);
    error += off.squaredNorm();
    size += u.squaredNorm();
  }
  return std::sqrt(error / size);
}

ExactProblem standing_wave(int cells, double cfl, const AlphaPolicy& policy) {
  ExactProblem problem;
  problem.name = "standing wave";
  const double h = 1.0 / cells, c = sound_speed(elastic_material());
  problem.steps = static_cast<int>(std::ceil(1.125 / c / (cfl * h / c)));
  const double dt = 1.125 / c / problem.steps;
  problem.scene = elastic_scene(problem.name, h, dt, policy.alpha(dt));
  problem.scene.grid.periodic = Vec3(1, 4 * h, 4 * h);
  fill(problem, cells, 4, 4);
  // A/h ≤ ½ at 128 cells: beyond 1–2 cells of displacement FLIP rings.
  constexpr double A = 0.004;
  problem.displacement = [c](const Vec3& X, double t) {
    return Vec3(A * std::sin(two_pi * X.x()) * std::sin(two_pi * c * t), 0, 0);
  };
  for (std::size_t p = 0; p < problem.X.size(); ++p)
    problem.initial.particles.v[p].x() = A * two_pi * c * std::sin(two_pi * problem.X[p].x());
  return problem;
}

ExactProblem manufactured(int cells, double cfl, const AlphaPolicy& policy) {
  ExactProblem problem;
  problem.name = "manufactured solution";
  const Material snow = elastic_material();
  const double h = 1.0 / cells, c = sound_speed(snow), omega = two_pi * c;
  problem.steps = static_cast<int>(std::ceil(0.625 / c / (cfl * h / c)));
  const double dt = 0.625 / c / problem.steps;
  problem.scene = elastic_scene(problem.name, h, dt, policy.alpha(dt));
  problem.scene.grid.periodic = Vec3(1, 1, 1);
  fill(problem, cells, cells, cells);
  constexpr double A = 0.01;
  problem.displacement = [omega](const Vec3& X, double t) {
    const double a = A * std::sin(omega * t);
    return Vec3(a * std::sin(two_pi * X.x()), a * std::sin(two_pi * X.y()),
                a * std::sin(two_pi * X.z()));
  };
  // P_ii = 2μ(F_i − 1) + λ(J−1)J/F_i with J = F_i q: ∂P_ii/∂X_i = (2μ + λq²) ∂F_i/∂X_i.
  problem.body_force = [omega, snow](const Vec3& X, double t) {
    const double a = A * std::sin(omega * t);
    Vec3 F, b;
    for (int i = 0; i < 3; ++i) F[i] = 1 + two_pi * a * std::cos(two_pi * X[i]);
    for (int i = 0; i < 3; ++i) {
      const double q = F[(i + 1) % 3] * F[(i + 2) % 3];
      const double u = a * std::sin(two_pi * X[i]);
      const double stress_divergence =
          -(2 * snow.mu_0() + snow.lambda_0() * q * q) * two_pi * two_pi * u;
      b[i] = -omega * omega * u - stress_divergence / snow.density;
    }
    return b;
  };
  for (std::size_t p = 0; p < problem.X.size(); ++p)
    for (int i = 0; i < 3; ++i)
      problem.initial.particles.v[p][i] = A * omega * std::sin(two_pi * problem.X[p][i]);
  return problem;
}

ExactProblem column(int cells, double cfl, const AlphaPolicy& policy) {
  ExactProblem problem;
  problem.name = "column";
  const Material snow = elastic_material();
  const double h = 1.0 / cells, c = sound_speed(snow), dt = cfl * h / c;
  problem.scene = elastic_scene(problem.name, h, dt, policy.alpha(dt));
  problem.scene.gravity = Vec3(0, 0, -9.81);
  problem.scene.grid.periodic = Vec3(4 * h, 4 * h, 0);
  // The ground stays off the nodes: at φ = 0 the response would be discontinuous.
  problem.scene.grid.origin = Vec3(0, 0, -0.3 * h);
  Collider ground;
  ground.shape = HalfSpace{};
  ground.sticky = true;
  problem.scene.colliders.push_back(ground);
  fill(problem, 4, 4, cells);
  const double g_over_M = 9.81 / (c * c);
  // u = ∫ (F−1) dX from the ground up, F − 1 = −ρg(H−X)/M with H = 1.
  problem.displacement = [g_over_M](const Vec3& X, double) {
    return Vec3(0, 0, -g_over_M * (X.z() - 0.5 * X.z() * X.z()));
  };
  Particles& p = problem.initial.particles;
  for (std::size_t at = 0; at < p.size(); ++at) {
    p.x[at] += problem.displacement(problem.X[at], 0);
    p.F_E[at](2, 2) = 1 - g_over_M * (1 - problem.X[at].z());
  }
  // With α = 0 the slowest mode, k = π/2H, decays at the rate h²k²/(6Δt): 5 time
  // constants settle what the exact state is off the discrete equilibrium to 0.7 %.
  const double rate = h * h * M_PI * M_PI / 4 / (6 * dt);
  problem.steps = static_cast<int>(std::ceil(5 / rate / dt));
  return problem;
}

}  // namespace firn::exact
