// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Dense>
#include <Eigen/SVD>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "reference/constitutive.hpp"
#include "reference/polar.hpp"
#include "verification/support/eps.hpp"
#include "verification/tests/reference/scenes.hpp"

namespace firn::reference {
namespace {

using test::Random;
using WideMat3 = Eigen::Matrix<long double, 3, 3>;

const Lame snow{1.4e5 / 2.4, 1.4e5 * 0.2 / (1.2 * 0.6)};  // E_0 = 1.4e5, ν = 0.2

Mat3 random_F(Random& random, double size = 0.1) { return Mat3::Identity() + size * random.mat3(); }

Mat3 random_rotation(Random& random) { return rotation(random.mat3()); }

/// Ψ in extended precision, with Eigen's SVD.
long double wide_energy(const Lame& lame, const WideMat3& F) {
  Eigen::Matrix<long double, 3, 1> sigma = Eigen::JacobiSVD<WideMat3>(F).singularValues();
  const long double J = F.determinant();
  if (J < 0) sigma[2] = -sigma[2];
  return lame.mu * (sigma - decltype(sigma)::Ones()).squaredNorm() +
         lame.lambda / 2 * (J - 1) * (J - 1);
}

/// Fourth-order central difference of f(t) at 0.
template <class Function>
auto slope(const Function& f, double step) -> decltype(f(step)) {
  const auto near_1 = f(step), near_2 = f(-step), far_1 = f(2 * step), far_2 = f(-2 * step);
  return ((8 * (near_1 - near_2) - (far_1 - far_2)) / (12 * step));
}

TEST(Constitutive, LameParametersOfThePaper) {
  const Material material;
  EXPECT_DOUBLE_EQ(lame(material, Mat3::Identity()).mu, 58333.333333333336);
  EXPECT_DOUBLE_EQ(lame(material, Mat3::Identity()).lambda, 38888.888888888891);
}

TEST(Constitutive, HardeningFollowsTheVolumeOfF_P) {
  Material material;
  EXPECT_EQ(hardening(material, Mat3::Identity()), 1);
  const Mat3 halved = Vec3(0.5, 1, 1).asDiagonal();
  EXPECT_NEAR(hardening(material, halved), std::exp(5.0), 2 * eps * std::exp(5.0));
  EXPECT_DOUBLE_EQ(lame(material, halved).mu, snow.mu * hardening(material, halved));
  EXPECT_DOUBLE_EQ(lame(material, halved).lambda, snow.lambda * hardening(material, halved));
  double last = std::numeric_limits<double>::infinity();
  for (double J_P = 0.5; J_P < 1.5; J_P += 0.01) {
    const double factor = hardening(material, Vec3(1, J_P, 1).asDiagonal());
    EXPECT_LT(factor, last);
    last = factor;
  }
  material.hardening = 0;
  EXPECT_EQ(hardening(material, halved), 1);
  material.hardening = 10;  // e^{ξ(1−J_P)} passes the largest double between J_P = −69.9 and −70
  EXPECT_TRUE(std::isfinite(hardening(material, Vec3(1, 1, -69.9).asDiagonal())));
  EXPECT_TRUE(std::isinf(hardening(material, Vec3(1, 1, -70).asDiagonal())));
}

TEST(Constitutive, EnergyAgainstExtendedPrecision) {
  Random random(1);
  for (int n = 0; n < 200; ++n) {
    const Mat3 F = random_F(random, n % 2 == 0 ? 0.1 : 1);
    const double exact = static_cast<double>(wide_energy(snow, F.cast<long double>()));
    // σ and J have errors of a few eps·‖F‖², Ψ is quadratic in σ − 1 and J − 1
    EXPECT_NEAR(energy_density(snow, F), exact, 50 * eps * (exact + snow.mu * F.squaredNorm()));
  }
}

TEST(Constitutive, StressIsTheDerivativeOfTheEnergy) {
  Random random(2);
  for (int n = 0; n < 50; ++n) {
    const Mat3 F = random_F(random, n % 2 == 0 ? 0.03 : 0.4), dF = random.mat3();
    const auto energy = [&](double t) {
      return wide_energy(snow, (F + t * dF).cast<long double>());
    };
    const double derivative = static_cast<double>(slope(energy, 1e-4));
    // (1e-4)⁴ of truncation times derivatives that grow for σ2 + σ3 small; 1e-13 of roundoff of F +
    // t dF
    EXPECT_NEAR(piola_stress(snow, F).cwiseProduct(dF).sum(), derivative, 1e-9 * snow.mu);
  }
}

TEST(Constitutive, KirchhoffStress) {
  Random random(3);
  for (int n = 0; n < 100; ++n) {
    const Mat3 F = random_F(random, 0.5);
    const Mat3 tau = kirchhoff_stress(snow, F);
    const double size = snow.mu * (1 + F.squaredNorm() * F.squaredNorm());
    EXPECT_LE((tau - piola_stress(snow, F) * F.transpose()).norm(), 20 * eps * size);
    EXPECT_LE((tau - tau.transpose()).norm(), 20 * eps * size);  // angular momentum
  }
}

TEST(Constitutive, ObjectiveAndIsotropic) {
  Random random(4);
  for (int n = 0; n < 100; ++n) {
    const Mat3 F = random_F(random, 0.3), Q = random_rotation(random), P = piola_stress(snow, F);
    EXPECT_LE((piola_stress(snow, Q * F) - Q * P).norm(), 1e-12 * snow.mu);
    EXPECT_LE((piola_stress(snow, F * Q) - P * Q).norm(), 1e-12 * snow.mu);
    EXPECT_LE(piola_stress(snow, Q).norm(), 1e-13 * snow.mu);  // P(R) = 0
  }
  EXPECT_EQ(piola_stress(snow, Mat3::Identity()), Mat3(Mat3::Zero()));
}

TEST(Constitutive, ClosedForms) {
  const double mu = snow.mu, lambda = snow.lambda;
  for (const double s : {0.7, 0.975, 1.0, 1.2}) {
    // P(sI) = [2μ(s−1) + λ(s³−1)s²] I
    const Mat3 expected = (2 * mu * (s - 1) + lambda * (s * s * s - 1) * s * s) * Mat3::Identity();
    EXPECT_LE((piola_stress(snow, s * Mat3::Identity()) - expected).norm(), 10 * eps * mu);
    // Uniaxial: P11 = (λ+2μ)(F−1), exactly linear
    const Mat3 P = piola_stress(snow, Vec3(s, 1, 1).asDiagonal());
    EXPECT_NEAR(P(0, 0), (lambda + 2 * mu) * (s - 1), 10 * eps * mu);
  }
  // Simple shear with S = √(4+γ²)
  for (const double gamma : {1e-6, 0.1, 1.0, 3.0}) {
    Mat3 F = Mat3::Identity();
    F(0, 1) = gamma;
    const Mat3 tau = kirchhoff_stress(snow, F);
    const double S = std::sqrt(4 + gamma * gamma);
    const double tolerance = 20 * eps * mu * (1 + gamma * gamma);
    // First row: F_12 = γ, so the sheared direction takes the γ² terms.
    EXPECT_NEAR(tau(1, 1), 2 * mu * (1 - 2 / S), tolerance);
    EXPECT_NEAR(tau(0, 1), 2 * mu * gamma * (1 - 1 / S), tolerance);
    EXPECT_NEAR(tau(0, 0), 2 * mu * (1 + gamma * gamma - (2 + gamma * gamma) / S), tolerance);
    EXPECT_NEAR(tau(2, 2), 0, tolerance);
  }
}

TEST(Constitutive, CofactorWithoutAnInverse) {
  Random random(5);
  for (int n = 0; n < 50; ++n) {
    const Mat3 F = random.mat3(), dF = random.mat3();
    EXPECT_LE((cofactor(F) - F.determinant() * F.inverse().transpose()).norm(),
              1e-13 * F.norm() * F.norm() / std::abs(F.determinant()));
    // cof is quadratic: cof(F + dF) = cof F + δC + cof dF, no truncation
    EXPECT_LE((cofactor(F + dF) - cofactor(F) - cofactor_differential(F, dF) - cofactor(dF)).norm(),
              100 * eps);
  }
  EXPECT_EQ(cofactor(Vec3(2, 0, 0).asDiagonal()), Mat3(Mat3::Zero()));  // rank 1
  EXPECT_EQ(cofactor(Vec3(2, 3, 0).asDiagonal()), Mat3(Vec3(0, 0, 6).asDiagonal()));
}

TEST(StressDifferential, AgainstDifferencesOfTheStress) {
  Random random(6);
  for (int n = 0; n < 50; ++n) {
    const Mat3 F = random_F(random, n % 2 == 0 ? 0.03 : 0.2), dF = random.mat3().normalized();
    const auto P = [&](double t) -> Mat3 { return piola_stress(snow, F + t * dF); };
    const StressDifferential A(snow, F);
    // step 1e-3: (1e-3)⁴ = 1e-12 of truncation, 1e-15/1e-3 = 1e-12 of roundoff, both times the
    // size of higher derivatives, some 10
    EXPECT_LE((A(dF) - slope(P, 1e-3)).norm(), 1e-10 * snow.mu) << F;
    const auto R = [&](double t) -> Mat3 { return rotation(F + t * dF); };
    EXPECT_LE((A.rotation_differential(dF) - slope(R, 1e-3)).norm(), 1e-10) << F;
  }
}

/// The error of a difference quotient falls as step⁴ and then grows as 1/step: a
/// wrong derivative shows no such V.
TEST(StressDifferential, ErrorOfTheDifferencesFormsAV) {
  Random random(7);
  const Mat3 F = random_F(random, 0.2), dF = random.mat3();
  const StressDifferential A(snow, F);
  const auto P = [&](double t) -> Mat3 { return piola_stress(snow, F + t * dF); };
  const auto error = [&](double step) { return (A(dF) - slope(P, step)).norm() / snow.mu; };
  EXPECT_NEAR(std::log2(error(0.04) / error(0.02)), 4, 0.3);
  EXPECT_GT(error(1e-8), 10 * error(1e-3));
}

TEST(StressDifferential, Symmetric) {
  Random random(8);
  for (int n = 0; n < 100; ++n) {
    Mat3 F = random_F(random, 0.5);
    if (n % 5 == 0) F.col(0) *= -1;  // inverted
    const StressDifferential A(snow, F);
    const Mat3 a = random.mat3(), b = random.mat3();
    const Svd usv = svd(F);
    const double dR_size = 1 + 1 / std::abs(usv.sigma[1] + usv.sigma[2]);
    EXPECT_NEAR(a.cwiseProduct(A(b)).sum(), b.cwiseProduct(A(a)).sum(), 1e-13 * snow.mu * dR_size);
  }
}

/// Both where the polar factor has no derivative and beside it: finite, symmetric.
TEST(StressDifferential, GuardedWhereTheRotationIsNotDifferentiable) {
  const Vec3 sigmas[] = {{1, 0.5, -0.5}, {1, 0, 0}, {0, 0, 0}, {1, 1, -1}, {2, 1, -1 + 1e-12}};
  Random random(9);
  for (const Vec3& sigma : sigmas) {
    const Mat3 F = random_rotation(random) * sigma.asDiagonal() * random_rotation(random);
    const StressDifferential A(snow, F);
    for (int n = 0; n < 20; ++n) {
      const Mat3 a = random.mat3(), b = random.mat3();
      EXPECT_TRUE(A(a).allFinite());
      const double scale = A(a).norm() * b.norm() + A(b).norm() * a.norm();
      EXPECT_NEAR(a.cwiseProduct(A(b)).sum(), b.cwiseProduct(A(a)).sum(), 1e-6 * scale);
    }
  }
}

/// Repeated singular values are no special case: K = tr(S) I − S is regular there.
TEST(StressDifferential, RepeatedSingularValues) {
  const StressDifferential A(snow, Mat3::Identity());
  Random random(10);
  const Mat3 dF = random.mat3();
  // At F = I: dP = 2μ sym(dF) + λ tr(dF) I, linear elasticity
  const Mat3 expected =
      snow.mu * (dF + dF.transpose()) + snow.lambda * dF.trace() * Mat3::Identity();
  EXPECT_LE((A(dF) - expected).norm(), 20 * eps * snow.mu);
}

TEST(Constitutive, InvertedParticlesArePushedBack) {
  // F = diag(1, 1, −s): the energy grows with s, the stress drives the third axis to +1.
  double last = 0;
  for (const double s : {0.0, 0.1, 0.5, 1.0}) {
    const Mat3 F = Vec3(1, 1, -s).asDiagonal();
    const double energy = energy_density(snow, F);
    EXPECT_GT(energy, last);
    EXPECT_LT(piola_stress(snow, F)(2, 2), 0);
    last = energy;
  }
  EXPECT_LE(piola_stress(snow, Mat3::Zero()).norm(), 4 * snow.mu);  // finite at F = 0
}

}  // namespace
}  // namespace firn::reference
