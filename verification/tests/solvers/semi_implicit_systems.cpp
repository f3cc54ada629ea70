// SPDX-License-Identifier: BSD-3-Clause
#include "verification/tests/solvers/semi_implicit_systems.hpp"

#include <cmath>
#include <ostream>

#include "verification/check/implicit_residual.hpp"
#include "verification/support/builtin_registry.hpp"
#include "verification/support/snow.hpp"

namespace firn::test {

std::unique_ptr<Solver> Subject::create(int threads) const {
  return fixtures::builtin_registry().create(name, {precision, threads});
}

std::string text(const Subject& subject) {
  return subject.name + "_" + std::string(firn::name(subject.precision));
}

void PrintTo(const Subject& subject, std::ostream* out) { *out << text(subject); }

std::vector<Subject> subjects() {
  std::vector<Subject> all;
  for (const SolverEntry& entry : fixtures::builtin_registry().entries())
    if (fixtures::builtin_registry().traits(entry.name).semi_implicit)
      for (const Precision precision : entry.precisions) all.push_back({entry.name, precision});
  return all;
}

State random_snow(const Scene& scene, std::size_t n, double cells, std::uint64_t seed) {
  return fixtures::random_snow(scene, n, 0.5 * cells * scene.grid.spacing, seed);
}

Solved::Solved(const Scene& s, const State& state, const Subject& subject, double dt) : scene(s) {
  const auto solver = subject.create();
  solver->load(scene, state);
  solver->advance_through(Stage::grid_collisions, dt);
  solver->store(before);
  report = solver->advance_through(Stage::integration, dt);
  solver->store(after);
}

double inner(const Grid& grid, const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) sum += grid.m[i] * a[i].dot(b[i]);
  return sum;
}

double norm(const Grid& grid, const std::vector<Vec3>& a) { return std::sqrt(inner(grid, a, a)); }

Eigen::MatrixXd symmetric_matrix(const Solved& s, double dt) {
  const Grid& grid = s.before.grid;
  const check::Stencils stencils(s.scene, s.before.particles, grid,
                                 std::vector<Vec3>(s.before.particles.size(), Vec3::Zero()), 0);
  const auto n = static_cast<Eigen::Index>(3 * grid.size());
  Eigen::MatrixXd A(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    std::vector<Vec3> unit(grid.size(), Vec3::Zero());
    const double m_j = grid.m[static_cast<std::size_t>(j / 3)];
    unit[static_cast<std::size_t>(j / 3)][j % 3] = 1 / std::sqrt(m_j);
    const std::vector<Vec3> H = check::hessian(s.scene, s.before.particles, stencils, unit);
    for (Eigen::Index i = 0; i < n; ++i)
      A(i, j) = (i == j ? 1 : 0) + s.scene.integrator.implicitness * dt * dt *
                                       H[static_cast<std::size_t>(i / 3)][i % 3] /
                                       std::sqrt(grid.m[static_cast<std::size_t>(i / 3)]);
  }
  return A;
}

Eigen::MatrixXd projector(const Grid& grid) {
  const auto n = static_cast<Eigen::Index>(grid.size());
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (Eigen::Index i = 0; i < n; ++i)
    P.block<3, 3>(3 * i, 3 * i) = grid.free_directions[static_cast<std::size_t>(i)];
  return P;
}

Eigen::VectorXd weighted(const Grid& grid, const std::vector<Vec3>& v) {
  Eigen::VectorXd x(3 * static_cast<Eigen::Index>(grid.size()));
  for (std::size_t i = 0; i < grid.size(); ++i)
    x.segment<3>(3 * static_cast<Eigen::Index>(i)) = std::sqrt(grid.m[i]) * v[i];
  return x;
}

}  // namespace firn::test
