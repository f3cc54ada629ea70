// SPDX-License-Identifier: BSD-3-Clause
#include "verification/suite/probes.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace firn::suite {

Scene plain_scene() {
  Scene scene = fixtures::elastic_scene("suite", spacing, 1e-4);
  scene.flip = 1;
  return scene;
}

State rounded_snow(std::size_t n, double cells, std::uint64_t seed, const fixtures::Snow& snow) {
  State state = fixtures::random_snow(plain_scene(), n, 0.5 * cells * spacing, seed, snow);
  Particles& p = state.particles;
  for (std::size_t q = 0; q < n; ++q) {
    for (int a = 0; a < 3; ++a) p.x[q][a] = spacing * std::floor(p.x[q][a] / spacing * 4096) / 4096;
    p.v[q] = rounded(p.v[q]);
    p.m[q] = rounded(p.m[q]);
    p.F_E[q] = rounded(p.F_E[q]);
    p.F_P[q] = rounded(p.F_P[q]);
  }
  return state;
}

Real N(Real x) {
  const Real d = std::abs(x);
  if (d < 1) return (d / 2 - 1) * d * d + Real(2) / 3;
  if (d < 2) return (2 - d) * (2 - d) * (2 - d) / 6;
  return 0;
}

Real dN(Real x) {
  const Real d = std::abs(x), sign = x < 0 ? -1 : 1;
  if (d < 1) return sign * (1.5L * d - 2) * d;
  if (d < 2) return -sign * (2 - d) * (2 - d) / 2;
  return 0;
}

Vec3 position(const Scene& scene, const NodeIndex& n) {
  return scene.grid.origin + scene.grid.spacing * Vec3(n.i, n.j, n.k);
}

Matrix to_matrix(const Mat3& m) {
  Matrix result;
  for (int k = 0; k < 9; ++k) result[static_cast<std::size_t>(k)] = m(k / 3, k % 3);
  return result;
}

Mat3 to_mat3(const Matrix& m) {
  Mat3 result;
  for (int k = 0; k < 9; ++k)
    result(k / 3, k % 3) = static_cast<double>(m[static_cast<std::size_t>(k)]);
  return result;
}

namespace {

constexpr int cells_apart = 6;

int floor_divide(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

}  // namespace

LoneParticles::LoneParticles(int n, std::uint64_t seed) : edge(n) {
  fixtures::Random random(seed);
  Particles& p = state.particles;
  p.resize(static_cast<std::size_t>(n * n * n));
  constexpr double awkward[] = {0, 0x1p-12, 1 - 0x1p-12, 0.5, 0.25};
  for (std::size_t q = 0; q < p.size(); ++q) {
    const int at = static_cast<int>(q);
    const int index[3] = {at / (n * n), at / n % n, at % n};
    for (int a = 0; a < 3; ++a) {
      double s = std::floor(2048 * (random() + 1)) * 0x1p-12;
      if (at % 7 < 3) s = awkward[static_cast<std::size_t>(at / 7 + a * (at % 3)) % 5];
      p.x[q][a] = spacing * (cells_apart * (index[a] - n / 2) + s);
    }
    p.m[q] = 1;
    p.V_0[q] = spacing * spacing * spacing;
    p.id[q] = at;
  }
}

/// Nodes 6i − 1 … 6i + 2 are those of the particle in cell 6i.
std::size_t LoneParticles::owner(const NodeIndex& node) const {
  const auto along = [&](std::int32_t i) {
    return std::clamp(floor_divide(i + 1, cells_apart) + edge / 2, 0, edge - 1);
  };
  return static_cast<std::size_t>((along(node.i) * edge + along(node.j)) * edge + along(node.k));
}

namespace {

std::vector<Mat3> from_forces(const LoneParticles& lone) {
  const State state = run_through(lone.scene, lone.state, Stage::grid_forces, lone.scene.time.step);
  std::vector<Mat3> tau(lone.size(), Mat3::Zero());
  const Particles& p = lone.state.particles;
  for (std::size_t i = 0; i < state.grid.size(); ++i) {
    const std::size_t q = lone.owner(state.grid.node[i]);
    tau[q] -= state.grid.f[i] * (position(lone.scene, state.grid.node[i]) - p.x[q]).transpose() /
              p.V_0[q];
  }
  return tau;
}

/// Σ_i N'²/N along one axis, over h².
double sum_of_squares(const Scene& scene, double x) {
  const Real X = (static_cast<Real>(x)) / scene.grid.spacing;
  Real sum = 0;
  for (Real n = std::floor(X) - 1; n < std::floor(X) + 3; ++n)
    if (N(X - n) > 0) sum += dN(X - n) * dN(X - n) / N(X - n);
  return static_cast<double>(sum / (scene.grid.spacing * scene.grid.spacing));
}

/// Δt of the step from which τ is measured [s]: L = −(Δt²V/m) τ Σ∇w∇wᵀ/w is of size 1 at a tenth
/// of E_0, so that few digits of τ are lost in F' = (I + L) F.
constexpr double measuring_step = 0x1p-8;

/// m h²/(3Δt²V): how much τ each unit of L stands for [Pa]; ΣN'²/N is 3 or more along each axis.
constexpr double stress_of_unit_growth =
    1 / (3 * spacing * measuring_step * measuring_step);  // m = 1, V = h³

/// F⁻¹ by cofactors in extended precision.
Matrix inverse(const Mat3& F) {
  const Matrix M = to_matrix(F);
  const Real determinant = verification::det(M);
  Matrix result;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      result[3 * j + i] = (M[3 * a + c] * M[3 * b + d] - M[3 * a + d] * M[3 * b + c]) / determinant;
    }
  return result;
}

std::vector<Mat3> from_growth(const LoneParticles& lone) {
  Scene scene = lone.scene;
  for (Material& m : scene.materials)
    m.critical_compression = m.critical_stretch = std::numeric_limits<double>::infinity();
  const Particles& p = lone.state.particles;
  const double dt = measuring_step;
  const State after = run_steps(scene, lone.state, 1, dt);
  std::vector<Mat3> tau;
  for (std::size_t q = 0; q < lone.size(); ++q) {
    Matrix L = verification::multiply(to_matrix(after.particles.F_E[q]), inverse(p.F_E[q]));
    for (const std::size_t k : {0u, 4u, 8u}) L[k] -= 1;
    const Mat3 growth = to_mat3(L);
    Mat3 one;
    for (int a = 0; a < 3; ++a)
      one.col(a) =
          -growth.col(a) * p.m[q] / (dt * dt * p.V_0[q] * sum_of_squares(scene, p.x[q][a]));
    tau.push_back(one);
  }
  return tau;
}

}  // namespace

std::vector<Mat3> kirchhoff_stresses(const LoneParticles& lone) {
  return stops_at(Stage::grid_forces) ? from_forces(lone) : from_growth(lone);
}

double stress_roundoff(const Material& material, const Mat3& F_E, const Mat3& F_P) {
  const double hardening = std::exp(material.hardening * (1 - F_P.determinant()));
  // Solvers may keep F − I: numbers of size 1 however small F is.
  const double size = std::max(F_E.norm(), 1.0), J = std::abs(F_E.determinant());
  const double corotated = 2 * material.mu_0() * size * (size + 1.8);
  const double volumetric = material.lambda_0() * size * size * size * (2 * J + 1);
  // e^x turns an absolute error of x, ξ times some ten roundings of J_P, into a relative one.
  const double exponent = 10 * material.hardening * std::max(1.0, std::pow(F_P.norm(), 3) / 5);
  return (64 + exponent) * eps() * hardening * (corotated + volumetric);
}

double measured_stress_roundoff(const Material& material, const Mat3& F_E, const Mat3& F_P) {
  const double law = stress_roundoff(material, F_E, F_P);
  if (stops_at(Stage::grid_forces)) return law;
  // |τ| is below this; so many roundings are in `law`.
  const double hardening = std::exp(material.hardening * (1 - F_P.determinant()));
  const double size = std::max(F_E.norm(), 1.0), J = std::abs(F_E.determinant());
  const double tau = hardening * (2 * material.mu_0() * size * (size + 1.8) +
                                  material.lambda_0() * size * size * size * (2 * J + 1));
  // L sums 64 terms Δt v_i ⊗ ∇w_ip with v_i = Δt f_i/m_i. Each is right to the roundings of w_ip
  // (16, in m_i) and of ∇w_ip (16, in f_i and again in the sum), and the sum to those of a few
  // additions; Σ|N'_a||N'_b| beside the diagonal is below ΣN'²/N on it: 64 roundings of τ in each
  // of its 3 columns.
  const double gather = 3 * 64 * eps() * tau;
  // F' = (I + L) F: three products and sums, and the rounding of F' or F' − I where it is kept.
  // F⁻¹ turns what is lost back into L; (1 + |L|) of that are g + 1.05 |τ| of τ, with g the stress
  // of unit growth and 1.05 the range of ΣN'²/N.
  const double kept =
      8 * eps() * (stress_of_unit_growth + 1.05 * tau) * size * to_mat3(inverse(F_E)).norm();
  return law + gather + kept;
}

State before_stage(const Scene& scene, const State& state, Stage stage, double dt) {
  return run_through(scene, state, static_cast<Stage>(number(stage) - 1), dt);
}

Totals totals(const Particles& p) {
  Totals t;
  for (std::size_t q = 0; q < p.size(); ++q) {
    t.mass += p.m[q];
    t.momentum += p.m[q] * p.v[q];
    t.angular_momentum += p.m[q] * p.x[q].cross(p.v[q]);
    t.kinetic_energy += 0.5 * p.m[q] * p.v[q].squaredNorm();
    t.momentum_scale += p.m[q] * p.v[q].norm();
    t.angular_scale += p.m[q] * p.x[q].norm() * p.v[q].norm();
  }
  return t;
}

Totals totals(const Scene& scene, const Grid& g, const std::vector<Vec3>& v) {
  Totals t;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const Vec3 x_i = position(scene, g.node[i]);
    t.mass += g.m[i];
    t.momentum += g.m[i] * v[i];
    t.angular_momentum += g.m[i] * x_i.cross(v[i]);
    t.kinetic_energy += 0.5 * g.m[i] * v[i].squaredNorm();
    t.momentum_scale += g.m[i] * v[i].norm();
    t.angular_scale += g.m[i] * x_i.norm() * v[i].norm();
  }
  return t;
}

std::size_t place_of(const Grid& grid, const NodeIndex& node) {
  const auto at = std::lower_bound(grid.node.begin(), grid.node.end(), node);
  return at != grid.node.end() && *at == node ? static_cast<std::size_t>(at - grid.node.begin())
                                              : grid.size();
}

}  // namespace firn::suite
