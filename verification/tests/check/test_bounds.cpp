// SPDX-License-Identifier: BSD-3-Clause
/// The error bounds themselves: never exceeded by a perturbation of the size that they
/// assume, and not so wide that nothing could fail.

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <gtest/gtest.h>

#include "verification/check/bounds.hpp"
#include "verification/check/check.hpp"
#include "verification/check/conditioning.hpp"
#include "verification/check/fields.hpp"
#include "verification/check/stencil.hpp"
#include "verification/support/snow_cases.hpp"
#include "verification/tests/check/solvers.hpp"

namespace firn::test {
namespace {

using check::StencilNode;
using check::Stencils;

/// All nodes of [−4, 4]³.
Grid block_of_nodes() {
  Grid grid;
  for (int i = -4; i <= 4; ++i)
    for (int j = -4; j <= 4; ++j)
      for (int k = -4; k <= 4; ++k) grid.node.push_back({i, j, k});
  return grid;
}

Scene unit_grid() {
  Scene scene;
  scene.grid.spacing = 0.5;
  scene.materials.emplace_back();
  return scene;
}

Particles one_particle(const Vec3& x) {
  Particles p;
  p.resize(1);
  p.x[0] = x;
  p.m[0] = 1;
  return p;
}

std::vector<StencilNode> stencil_at(const Scene& scene, const Particles& p, const Grid& grid,
                                    double x_error) {
  std::vector<StencilNode> nodes;
  Stencils(scene, p, grid, {Vec3::Constant(x_error)}, 0).around(0, nodes);
  return nodes;
}

TEST(Stencil, OnANodeTheWeightsAreProductsOfOneSixthAndTwoThirds) {
  const Scene scene = unit_grid();
  const auto nodes = stencil_at(scene, one_particle(Vec3::Zero()), block_of_nodes(), 0);
  double sum = 0;
  Vec3 gradient = Vec3::Zero();
  for (const StencilNode& s : nodes) {
    sum += s.w;
    gradient += s.grad_w;
  }
  EXPECT_NEAR(sum, 1, 1e-15);
  EXPECT_NEAR(gradient.norm(), 0, 1e-15 / scene.grid.spacing);
  double largest = 0;
  for (const StencilNode& s : nodes) largest = std::max(largest, s.w);
  EXPECT_NEAR(largest, 8.0 / 27, 1e-15);
}

TEST(Stencil, ItsErrorsBoundWhatADisplacementDoes) {
  const Scene scene = unit_grid();
  const Grid grid = block_of_nodes();
  fixtures::Random random(1);
  const double step = 1e-4 * scene.grid.spacing;
  double sharpest = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    // Every fourth within the error of a cell boundary, where the set of nodes changes.
    Vec3 x = scene.grid.spacing * random.vec3();
    if (trial % 4 == 0) x[trial % 3] = 0.5 * step * random();
    const Particles p = one_particle(x), moved = one_particle(x + step * random.vec3());
    std::vector<double> w(grid.size(), 0.0);
    std::vector<Vec3> g(grid.size(), Vec3::Zero());
    for (const StencilNode& s : stencil_at(scene, moved, grid, 0)) {
      w[static_cast<std::size_t>(s.node)] = s.w;
      g[static_cast<std::size_t>(s.node)] = s.grad_w;
    }
    for (const StencilNode& s : stencil_at(scene, p, grid, step)) {
      const auto i = static_cast<std::size_t>(s.node);
      ASSERT_LE(std::abs(w[i] - s.w), s.w_error + 1e-16);
      ASSERT_LE((g[i] - s.grad_w).norm(), s.grad_w_error + 1e-15);
      sharpest = std::max(sharpest, std::abs(w[i] - s.w) / (s.w_error + 1e-300));
      w[i] = 0;  // seen
    }
    for (const double unseen : w) ASSERT_EQ(unseen, 0);
  }
  EXPECT_GT(sharpest, 0.9);
}

TEST(Stencil, ANodeAcrossTheCellBoundaryIsForeseen) {
  const Scene scene = unit_grid();
  // A hair above the boundary of cells: node −2 is out of reach along x, but a rounded
  // position may touch it. The reference's grid does not hold it.
  const double hair = 1e-12;
  const Particles p = one_particle({hair, 0.2, 0.2});
  Grid grid;
  for (const NodeIndex& n : block_of_nodes().node)
    if (n.i >= -1) grid.node.push_back(n);
  const Stencils stencils(scene, p, grid, {Vec3::Constant(4 * hair)}, 0);
  ASSERT_FALSE(stencils.stray_mass().empty());
  for (const auto& [node, mass] : stencils.stray_mass()) {
    EXPECT_EQ(node.i, -2);
    EXPECT_LE(mass, std::pow(8 * hair / scene.grid.spacing, 3));  // N ∝ (2 − d)³/6
  }
}

/// τ and the return map in long double: 64 bits of mantissa against 53.
using MatL = Eigen::Matrix<long double, 3, 3>;
struct PolarL {
  MatL U, V;
  Eigen::Matrix<long double, 3, 1> sigma;
};
PolarL svd(const MatL& F) {
  const Eigen::JacobiSVD<MatL> s(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  PolarL p{s.matrixU(), s.matrixV(), s.singularValues()};
  if ((p.U * p.V.transpose()).determinant() < 0) {
    p.U.col(2) = -p.U.col(2);
    p.sigma[2] = -p.sigma[2];
  }
  return p;
}
MatL tau(const Material& m, const Mat3& F_E, const Mat3& F_P) {
  const MatL F = F_E.cast<long double>();
  const PolarL p = svd(F);
  const long double J = F.determinant();
  const long double hardening =
      std::exp(m.hardening * (1 - MatL(F_P.cast<long double>()).determinant()));
  return hardening * (2 * m.mu_0() * (F - p.U * p.V.transpose()) * F.transpose() +
                      m.lambda_0() * (J - 1) * J * MatL::Identity());
}

TEST(Conditioning, StressChangesNoMoreThanItsBound) {
  const Material material;
  fixtures::Random random(1);
  double sharpest = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double strain = trial % 3 == 0 ? 0.02 : trial % 3 == 1 ? 0.3 : 0.7;
    const Mat3 F_E = Mat3::Identity() + strain * random.mat3();
    const Mat3 F_P = Mat3::Identity() + 0.1 * random.mat3();
    const Mat3 dE = 1e-8 * random.mat3(), dP = 1e-8 * random.mat3();
    const double change =
        static_cast<double>((tau(material, F_E + dE, F_P + dP) - tau(material, F_E, F_P)).norm());
    const double bound = check::kirchhoff_stress(material, F_E, F_P, dE.norm(), dP.norm(), 0).error;
    // First order: 1e-8 of curvature is left, more where σ2 + σ3 is small.
    ASSERT_LE(change, 1.001 * bound) << F_E;
    sharpest = std::max(sharpest, change / bound);
  }
  EXPECT_GT(sharpest, 0.2);
}

TEST(Conditioning, ReturnMapChangesNoMoreThanItsBound) {
  const Material material;
  const auto map = [&](const MatL& F_hat, const MatL& F_P) {
    PolarL p = svd(F_hat);
    for (int k = 0; k < 3; ++k)
      p.sigma[k] = std::min<long double>(
          material.largest_elastic_stretch(),
          std::max<long double>(material.smallest_elastic_stretch(), p.sigma[k]));
    const MatL F_E = p.U * p.sigma.asDiagonal() * p.V.transpose();
    return std::pair<MatL, MatL>(F_E, F_E.inverse() * F_hat * F_P);
  };
  fixtures::Random random(1);
  double sharpest = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double strain = trial % 3 == 0 ? 0.02 : trial % 3 == 1 ? 0.3 : 0.6;
    const Mat3 F_hat = Mat3::Identity() + strain * random.mat3();
    if (F_hat.determinant() < 0.05) continue;  // near-singular: first order says little
    const Mat3 F_P = Mat3::Identity() + 0.1 * random.mat3();
    const Mat3 dF = 1e-9 * random.mat3(), dP = 1e-9 * random.mat3();
    const auto [E0, P0] = map(F_hat.cast<long double>(), F_P.cast<long double>());
    const auto [E1, P1] = map((F_hat + dF).cast<long double>(), (F_P + dP).cast<long double>());
    const check::ReturnErrors bound =
        check::plastic_return(material, F_hat, dF.norm(), F_P, dP.norm(), 0);
    ASSERT_LE(static_cast<double>((E1 - E0).norm()), 1.001 * bound.F_E) << F_hat;
    ASSERT_LE(static_cast<double>((P1 - P0).norm()), 1.001 * bound.F_P) << F_hat;
    sharpest = std::max(sharpest, static_cast<double>((E1 - E0).norm()) / bound.F_E);
  }
  EXPECT_GT(sharpest, 0.5);
}

/// A relative error of 1e-10 in the largest number of any field is found in double.
class Sensitivity : public testing::TestWithParam<Stage> {};

TEST_P(Sensitivity, ARelativeErrorInTheTenthDigitIsFound) {
  const Stage stage = GetParam();
  const auto spoil = [](auto& values) {
    const auto largest =
        std::max_element(values.begin(), values.end(), [](const auto& a, const auto& b) {
          using T = std::decay_t<decltype(a)>;
          if constexpr (std::is_same_v<T, double>)
            return a < b;
          else
            return a.norm() < b.norm();
        });
    *largest *= 1 + 1e-10;
  };
  for (const Field field : fields_written(stage)) {
    if (field == Field::node_free_directions) continue;
    Mistaken subject(stage, [&](const StageRun& run) {
      Particles& p = run.after.particles;
      Grid& g = run.after.grid;
      switch (field) {
        case Field::node_mass: return spoil(g.m);
        case Field::node_velocity: return spoil(g.v);
        case Field::node_force: return spoil(g.f);
        case Field::node_velocity_star: return spoil(g.v_star);
        case Field::node_velocity_new: return spoil(g.v_new);
        case Field::particle_volume: return spoil(p.V_0);
        case Field::particle_F_E: return spoil(p.F_E);
        case Field::particle_F_P: return spoil(p.F_P);
        case Field::particle_velocity: return spoil(p.v);
        default: return spoil(p.x);
      }
    });
    const fixtures::Case c = fixtures::lump_on_slope();
    const auto reference = make_reference();
    const CheckReport report = run_check(c.scene, c.state, *reference, subject, {.steps = 1});
    ASSERT_FALSE(report.valid()) << name(field);
    EXPECT_EQ(report.first_divergence->through, stage) << name(field);
    EXPECT_EQ(*report.first_divergence->field, field);
  }
}

INSTANTIATE_TEST_SUITE_P(Stages, Sensitivity, testing::ValuesIn(all_stages),
                         [](const auto& info) { return std::string(name(info.param)); });

}  // namespace
}  // namespace firn::test
