// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <gsl/gsl_deriv.h>
#include <gsl/gsl_integration.h>
#include <gtest/gtest.h>
#include <limits>
#include <memory>

#include "reference/kernel.hpp"
#include "reference/stencil.hpp"
#include "verification/support/eps.hpp"
#include "verification/tests/reference/scenes.hpp"

namespace firn::reference {
namespace {

using Wide = long double;

/// The kernel as printed, in extended precision, 2000 times finer than double.
/// Its cancellation at |x| = 2 costs relative accuracy there too, so the outer
/// branch is expanded about 2: with t = 2 − d it is t³/6 exactly.
Wide exact_N(Wide x) {
  const Wide d = std::abs(x);
  if (d < 1) return d * d * d / 2 - d * d + Wide(2) / 3;
  const Wide t = 2 - d;
  return d < 2 ? t * t * t / 6 : 0;
}

Wide exact_dN(Wide x) {
  const Wide d = std::abs(x), sign = x < 0 ? -1 : 1;
  if (d < 1) return sign * (1.5L * d * d - 2 * d);
  const Wide t = 2 - d;
  return d < 2 ? -sign * t * t / 2 : 0;
}

TEST(Kernel, ValuesForThePencil) {
  EXPECT_EQ(N(0), 2.0 / 3);
  EXPECT_DOUBLE_EQ(N(1), 1.0 / 6);
  EXPECT_DOUBLE_EQ(N(-1), 1.0 / 6);
  EXPECT_DOUBLE_EQ(N(0.5), 23.0 / 48);
  EXPECT_DOUBLE_EQ(N(1.5), 1.0 / 48);
  EXPECT_EQ(N(2), 0);
  EXPECT_EQ(N(-2), 0);
  EXPECT_EQ(N(7), 0);
  EXPECT_EQ(dN(0), 0);
  EXPECT_EQ(dN(1), -0.5);
  EXPECT_EQ(dN(-1), 0.5);
  EXPECT_DOUBLE_EQ(dN(0.5), -0.625);
  EXPECT_DOUBLE_EQ(dN(-1.5), 0.125);
  EXPECT_EQ(dN(2), 0);
  EXPECT_EQ(dN(-2), 0);
}

TEST(Kernel, AccurateOnItsWholeSupport) {
  double worst_N = 0, worst_dN = 0;
  const auto look_at = [&](double x) {
    const Wide n = exact_N(x), d = exact_dN(x);
    ASSERT_GE(N(x), 0);
    worst_N = std::max(worst_N, static_cast<double>(std::abs(N(x) - n) / n / eps));
    worst_dN = std::max(worst_dN, static_cast<double>(std::abs((dN(x) - d) / d) / eps));
  };
  for (int i = 1; i < 40000; ++i) look_at(i / 20000.0);
  for (double t = 0.5; t > 1e-16; t /= 1.7) {  // the ends, where the printed form fails
    look_at(2 - t);
    look_at(1 - t);
    look_at(t);
  }
  EXPECT_LE(worst_N, 4);
  EXPECT_LE(worst_dN, 4);
}

TEST(Kernel, EvenAndOddToTheLastBit) {
  test::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double x = 2.2 * random();
    EXPECT_EQ(N(x), N(-x));
    EXPECT_EQ(dN(x), -dN(-x));
  }
}

TEST(Kernel, SmoothAcrossItsKnots) {
  // C²: N and N' are continuous and N'' = −2 + 3d inside, 2 − d outside; both 1 at d = 1.
  EXPECT_DOUBLE_EQ(N_inner(1), N_outer(1));
  EXPECT_DOUBLE_EQ(dN_inner(1), dN_outer(1));
  const double step = 1e-5;
  const double left = (dN_inner(1) - dN_inner(1 - step)) / step;
  const double right = (dN_outer(1 - step) - dN_outer(1)) / step;
  EXPECT_NEAR(left, 1, 2 * step);  // |N'''| = 3
  EXPECT_NEAR(right, 1, step);     // |N'''| = 1
}

TEST(Kernel, DerivativeByGsl) {
  gsl_function f{[](double x, void*) { return N(x); }, nullptr};
  for (const double x : {-1.7, -1.2, -0.8, -0.3, 0.1, 0.45, 0.9, 1.01, 1.5, 1.9}) {
    double result = 0, error = 0;
    gsl_deriv_central(&f, x, 1e-3, &result, &error);
    EXPECT_NEAR(dN(x), result, std::max(error, 1e-10)) << x;
  }
}

TEST(Kernel, IntegralsByGsl) {
  // Gauss–Legendre with 5 points between knots: exact for polynomials up to degree 9.
  const auto integral = [](double (*g)(double, void*)) {
    gsl_function f{g, nullptr};
    std::unique_ptr<gsl_integration_glfixed_table, void (*)(gsl_integration_glfixed_table*)> rule(
        gsl_integration_glfixed_table_alloc(5), gsl_integration_glfixed_table_free);
    double sum = 0;
    for (int knot = -2; knot < 2; ++knot)
      sum += gsl_integration_glfixed(&f, knot, knot + 1, rule.get());
    return sum;
  };
  // Roundoff only.
  EXPECT_NEAR(integral([](double x, void*) { return N(x); }), 1, 8 * eps);
  EXPECT_NEAR(integral([](double x, void*) { return x * x * N(x); }), 1.0 / 3, 8 * eps);
  EXPECT_NEAR(integral([](double x, void*) { return N(x) * N(x); }), 151.0 / 315, 8 * eps);
  EXPECT_NEAR(integral([](double x, void*) { return dN(x); }), 0, 8 * eps);
}

/// Sums over the 64 nodes around a particle, as every step takes them.
struct Moments {
  double sum_w = 0, smallest_w = 1;
  Vec3 first = Vec3::Zero(), sum_grad = Vec3::Zero();
  Mat3 second = Mat3::Zero(), x_grad = Mat3::Zero();
  int nodes = 0;
};

Moments moments(const Scene& scene, const Vec3& x_p) {
  State state = test::particles_at_rest(scene);
  state.particles.x[0] = x_p;
  Stencils stencils;
  std::vector<NodeIndex> node;
  stencils.build(scene, state.particles, Stage::rasterize, node);
  Moments m;
  stencils.for_each_node_with_gradient(0, [&](std::size_t i, double w, const Vec3& grad_w) {
    const double h = scene.grid.spacing;
    const Vec3 from_p =
        Vec3(node[i].i, node[i].j, node[i].k) - (x_p - scene.grid.origin) / h;  // in units of h
    m.sum_w += w;
    m.smallest_w = std::min(m.smallest_w, w);
    m.first += w * from_p;
    m.second += w * from_p * from_p.transpose();
    m.sum_grad += grad_w * h;
    m.x_grad += from_p * h * grad_w.transpose();
    ++m.nodes;
  });
  return m;
}

class Weights : public testing::TestWithParam<double> {};

TEST_P(Weights, ReproducePolynomials) {
  const double distance = GetParam();  // from the grid's origin, in cells
  Scene scene = test::empty_scene();
  scene.grid.origin = Vec3(0.7, -3.1, 20);
  test::Random random(2);
  for (int n = 0; n < 500; ++n) {
    const Vec3 x_p =
        scene.grid.origin + scene.grid.spacing * (distance * Vec3(1, -1, 1) + 2 * random.vec3());
    const Moments m = moments(scene, x_p);
    // 64 products of three factors; positions are rounded to eps·|x/h| cells.
    const double position = 4 * (distance + 300) * eps;
    EXPECT_EQ(m.nodes, 64);
    EXPECT_GE(m.smallest_w, 0);
    EXPECT_NEAR(m.sum_w, 1, 8 * eps);
    EXPECT_LE(m.first.cwiseAbs().maxCoeff(), 12 * eps + position);
    // E[(x_i − x_p)²] = h²/3 along each axis, none mixed.
    EXPECT_LE((m.second - Mat3::Identity() / 3).cwiseAbs().maxCoeff(), 24 * eps + 4 * position);
    EXPECT_LE(m.sum_grad.cwiseAbs().maxCoeff(), 8 * eps);
    // Σ x_i ⊗ ∇w = I: fails by a factor h if the 1/h of the gradient is missing.
    EXPECT_LE((m.x_grad - Mat3::Identity()).cwiseAbs().maxCoeff(), 12 * eps + 4 * position);
  }
}

INSTANTIATE_TEST_SUITE_P(Distances, Weights, testing::Values(0.0, 100.0, 1e4, 1e8));

TEST(Weights, OnANode) {
  Scene scene = test::empty_scene();
  scene.grid.spacing = 0.5;  // exact quotients
  const Moments m = moments(scene, Vec3(1, -2, 0));
  EXPECT_NEAR(m.sum_w, 1, 2 * eps);
  EXPECT_LE(m.first.cwiseAbs().maxCoeff(), 2 * eps);
  EXPECT_EQ(m.smallest_w, 0);  // the fourth node along each axis is exactly 2 h away
}

/// The three weights of a row add up, the fraction being exact on both sides of a node.
TEST(Weights, OneUnitInTheLastPlaceBesideANode) {
  Scene scene = test::empty_scene();
  scene.grid.spacing = 1;
  for (const double x : {std::nextafter(3.0, 0.0), std::nextafter(3.0, 4.0), -1e-300, 1e-300,
                         -std::numeric_limits<double>::denorm_min()}) {
    const Moments m = moments(scene, Vec3::Constant(x));
    EXPECT_NEAR(m.sum_w, 1, 8 * eps) << x;
    EXPECT_LE(m.first.cwiseAbs().maxCoeff(), 12 * eps) << x;
    EXPECT_GE(m.smallest_w, 0) << x;
  }
}

}  // namespace
}  // namespace firn::reference
