// SPDX-License-Identifier: BSD-3-Clause
/// The constitutive law as the forces of lone particles show it.

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "verification/oracles/elastic_oracle.hpp"
#include "verification/suite/probes.hpp"

namespace firn::suite {
namespace {

/// τ of the particles for these F_E and F_P.
std::vector<Mat3> stresses(LoneParticles& lone, const std::vector<Mat3>& F_E) {
  lone.state.particles.F_E = F_E;
  return kirchhoff_stresses(lone);
}

std::vector<Mat3> near_identity(std::size_t n, double size, std::uint64_t seed) {
  fixtures::Random random(seed);
  std::vector<Mat3> F(n);
  for (Mat3& one : F) one = rounded(Mat3(Mat3::Identity() + size * random.mat3()));
  return F;
}

/// Ψ in extended precision.
Real energy(const Matrix& F, Real mu, Real lambda) {
  const verification::Svd usv = verification::svd_oracle(F);
  Real sum = 0;
  for (const Real s : usv.sigma) sum += (s - 1) * (s - 1);
  const Real J = verification::det(F);
  return mu * sum + lambda / 2 * (J - 1) * (J - 1);
}

/// P F_Eᵀ with P by fourth order differences of the energy: no formula for P is used.
FIRN_TEST(Constitutive, stress_is_the_derivative_of_the_energy) {
  LoneParticles lone(effort(5, 3), 21);
  const Material& m = lone.scene.materials[0];
  const std::vector<Mat3> F = near_identity(lone.size(), 0.1, 22);
  const std::vector<Mat3> tau = stresses(lone, F);
  const Real mu = m.mu_0(), lambda = m.lambda_0(), step = 1e-4L;
  for (std::size_t p = 0; p < F.size(); ++p) {
    Matrix P{};
    for (std::size_t k = 0; k < 9; ++k) {
      const auto at = [&](Real by) {
        Matrix moved = to_matrix(F[p]);
        moved[k] += by;
        return energy(moved, mu, lambda);
      };
      P[k] = (8 * (at(step) - at(-step)) - (at(2 * step) - at(-2 * step))) / (12 * step);
    }
    const Mat3 expected =
        to_mat3(verification::multiply(P, verification::transpose(to_matrix(F[p]))));
    // Truncation step⁴ = 1e-16 and roundoff 1e-19/1e-4, in units of μ: far below 1e-9 μ.
    within("τ = ∂Ψ/∂F_E F_Eᵀ", (tau[p] - expected).norm(),
           1e-11 * m.mu_0() + measured_stress_roundoff(m, F[p], Mat3::Identity()));
  }
}

FIRN_TEST(Constitutive, closed_forms) {
  LoneParticles lone(effort(5, 3), 23);
  const Material& m = lone.scene.materials[0];
  const double mu = m.mu_0(), lambda = m.lambda_0();
  fixtures::Random random(24);
  std::vector<Mat3> F(lone.size()), expected(lone.size());
  std::vector<const char*> which(lone.size());
  for (std::size_t p = 0; p < F.size(); ++p) {
    const double s = rounded(1 + 0.3 * random());
    switch (p % 4) {
      case 0: {
        const double J = s * s * s;
        F[p] = s * Mat3::Identity();
        expected[p] = (2 * mu * (s - 1) * s + lambda * (J - 1) * J) * Mat3::Identity();
        which[p] = "dilation s I";
        break;
      }
      case 1:
        // P_11 = (λ + 2μ)(s − 1): exactly linear.
        F[p] = Vec3(s, 1, 1).asDiagonal();
        expected[p] =
            Vec3((lambda + 2 * mu) * (s - 1) * s, lambda * (s - 1) * s, lambda * (s - 1) * s)
                .asDiagonal();
        which[p] = "uniaxial strain";
        break;
      case 2: {
        const double g = s - 1, S = std::sqrt(4 + g * g);
        F[p] = Mat3::Identity();
        F[p](0, 1) = g;
        expected[p].setZero();
        // 1 − 2/S and the like, without cancellation: S − 2 = γ²/(S + 2).
        const double below = g * g / (S * (S + 2));
        expected[p](0, 0) = 2 * mu * (g * g + below - g * g / S);
        expected[p](1, 1) = 2 * mu * below;
        expected[p](0, 1) = expected[p](1, 0) = 2 * mu * g * (1 - 1 / S);
        which[p] = "simple shear";
        break;
      }
      default:
        F[p] = rounded(fixtures::random_rotation(random));
        expected[p].setZero();
        which[p] = "rotation: no stress";
    }
  }
  const std::vector<Mat3> tau = stresses(lone, F);
  for (std::size_t p = 0; p < F.size(); ++p)
    within(which[p], (tau[p] - expected[p]).norm(),
           measured_stress_roundoff(m, F[p], Mat3::Identity()));
}

FIRN_TEST(Constitutive, symmetry_objectivity_isotropy) {
  LoneParticles lone(effort(5, 3), 25);
  const Material& m = lone.scene.materials[0];
  fixtures::Random random(26);
  const std::vector<Mat3> F = near_identity(lone.size(), 0.2, 27);
  std::vector<Mat3> Q, QF, FQ;
  for (const Mat3& one : F) {
    Q.push_back(fixtures::random_rotation(random));
    QF.push_back(rounded(Mat3(Q.back() * one)));
    FQ.push_back(rounded(Mat3(one * Q.back())));
  }
  const std::vector<Mat3> tau = stresses(lone, F), turned = stresses(lone, QF),
                          material = stresses(lone, FQ);
  for (std::size_t p = 0; p < F.size(); ++p) {
    const double roundoff = measured_stress_roundoff(m, F[p], Mat3::Identity());
    within("P F_Eᵀ symmetric", (tau[p] - tau[p].transpose()).norm(), roundoff);
    within("P(Q F) = Q P(F)", (turned[p] - Q[p] * tau[p] * Q[p].transpose()).norm(), 2 * roundoff);
    within("P(F Q) = P(F) Q", (material[p] - tau[p]).norm(), 2 * roundoff);
  }
}

/// det F_E < 0: R_E stays a rotation, the smallest singular value carries the sign.
FIRN_TEST(Constitutive, inverted_particles) {
  LoneParticles lone(effort(4, 3), 28);
  const Material& m = lone.scene.materials[0];
  std::vector<Mat3> F = near_identity(lone.size(), 0.1, 29);
  // Unequal enough that σ2 + σ3 is far from 0.
  for (Mat3& one : F) one = rounded(Mat3(one * Vec3(1.3, 1.1, -0.6).asDiagonal()));
  const std::vector<Mat3> tau = stresses(lone, F);
  for (std::size_t p = 0; p < F.size(); ++p) {
    Matrix D = to_matrix(F[p]);
    for (const std::size_t k : {0u, 4u, 8u}) D[k] -= 1;
    const Mat3 expected = to_mat3(verification::stress_oracle(D, m.mu_0(), m.lambda_0()));
    within(
        "stress of an inverted particle", (tau[p] - expected).norm(),
        2.5 * measured_stress_roundoff(m, F[p], Mat3::Identity()));  // (σ1)/(σ2 + σ3) is about 2.5
  }
}

FIRN_TEST(Constitutive, hardening) {
  LoneParticles lone(effort(5, 3), 30);
  Material& m = lone.scene.materials[0];
  m.hardening = 10;
  Particles& p = lone.state.particles;
  fixtures::Random random(31);
  const Mat3 F = rounded(Mat3(Mat3::Identity() + 0.01 * random.mat3()));
  Matrix D = to_matrix(F);
  for (const std::size_t k : {0u, 4u, 8u}) D[k] -= 1;
  const Mat3 soft = to_mat3(verification::stress_oracle(D, m.mu_0(), m.lambda_0()));
  for (std::size_t q = 0; q < lone.size(); ++q)
    p.F_P[q] = rounded(Mat3(Mat3::Identity() + 0.1 * random.mat3()));
  const std::vector<Mat3> tau = stresses(lone, std::vector<Mat3>(lone.size(), F));
  for (std::size_t q = 0; q < lone.size(); ++q) {
    const Real J_P = verification::det(to_matrix(p.F_P[q]));
    within("e^{ξ(1 − J_P)}", (tau[q] - static_cast<double>(std::exp(10 * (1 - J_P))) * soft).norm(),
           measured_stress_roundoff(m, F, p.F_P[q]));
  }
  // Crushed a hundredth more each: strictly stiffer, particle by particle.
  for (std::size_t q = 0; q < lone.size(); ++q)
    p.F_P[q] =
        rounded(Mat3(std::cbrt(1.2 - 0.01 * static_cast<double>(q % 60)) * Mat3::Identity()));
  const std::vector<Mat3> crushed = kirchhoff_stresses(lone);
  std::int64_t weaker = 0;
  for (std::size_t q = 1; q < lone.size(); ++q)
    if (q % 60 != 0 && crushed[q].norm() <= crushed[q - 1].norm()) ++weaker;
  expect("strictly monotone in J_P", weaker == 0);

  m.hardening = 0;
  std::vector<Mat3> F_P(lone.size(), 0.8 * Mat3::Identity());
  p.F_P = F_P;
  const std::vector<Mat3> crushed_without = kirchhoff_stresses(lone);
  for (Mat3& one : p.F_P) one.setIdentity();
  const std::vector<Mat3> fresh = kirchhoff_stresses(lone);
  for (std::size_t q = 0; q < lone.size(); ++q)
    within("ξ = 0: F_P has no part in the force", (crushed_without[q] - fresh[q]).norm(),
           measured_stress_roundoff(m, F, Mat3::Identity()));
}

/// Every particle has the parameters of its own material.
FIRN_TEST(Constitutive, two_materials) {
  LoneParticles lone(effort(4, 3), 32);
  Material other = elastic_material();
  other.name = "other";
  other.youngs_modulus = 3e5;
  other.poisson_ratio = 0.375;
  other.density = 200;
  lone.scene.materials.push_back(other);
  Particles& p = lone.state.particles;
  for (std::size_t q = 0; q < lone.size(); ++q) p.material[q] = q % 2 == 0 ? 0 : 1;
  const double s = 1.125, J = s * s * s;
  const std::vector<Mat3> tau =
      stresses(lone, std::vector<Mat3>(lone.size(), s * Mat3::Identity()));
  for (std::size_t q = 0; q < lone.size(); ++q) {
    const Material& m = lone.scene.materials[q % 2];
    const double pressure = 2 * m.mu_0() * (s - 1) * s + m.lambda_0() * (J - 1) * J;
    within("stress by the particle's material", (tau[q] - pressure * Mat3::Identity()).norm(),
           measured_stress_roundoff(m, p.F_E[q], p.F_P[q]));
  }
}

/// The return mapping on its own, with nodes at rest.
class Plasticity {
 public:
  explicit Plasticity(int edge) : lone_(edge, 40) {
    Material& m = lone_.scene.materials[0];
    m.critical_compression = 2.5e-2;
    m.critical_stretch = 7.5e-3;
    // Every third particle is of a material with other limits, and unhurt by these strains.
    lone_.scene.materials.push_back(elastic_material());
    lone_.scene.materials.back().name = "without limits";
    for (std::size_t p = 0; p < lone_.size(); p += 3) lone_.state.particles.material[p] = 1;
    state_ = before_stage(lone_.scene, lone_.state, Stage::deformation, 1e-4);
    for (Vec3& v : state_.grid.v_new) v.setZero();
  }
  Particles run(const std::vector<Mat3>& F_E, const std::vector<Mat3>& F_P) {
    state_.particles.F_E = F_E;
    state_.particles.F_P = F_P;
    return run_through(lone_.scene, state_, Stage::deformation, 1e-4).particles;
  }
  std::size_t size() const { return lone_.size(); }

 private:
  LoneParticles lone_;
  State state_;
};

FIRN_TEST(Constitutive, return_mapping) {
  FIRN_NEEDS_STOP(Stage::integration);
  FIRN_NEEDS_STOP(Stage::deformation);
  Plasticity step_7(effort(6, 3));
  const std::vector<Mat3> F = near_identity(step_7.size(), 0.05, 41),
                          F_P = near_identity(step_7.size(), 0.1, 42);
  const Particles once = step_7.run(F, F_P);
  const Particles twice = step_7.run(once.F_E, once.F_P);
  std::vector<Mat3> nearly = F;
  for (Mat3& one : nearly) one *= 1 + 64 * eps();
  const Particles beside = step_7.run(nearly, F_P);
  std::int64_t yielded = 0;
  for (std::size_t p = 0; p < F.size(); ++p) {
    // A clamped value may lie a rounding beyond its limit and be clamped again.
    within("idempotent: F_E", (twice.F_E[p] - once.F_E[p]).norm(), 32 * eps());
    within("idempotent: F_P", (twice.F_P[p] - once.F_P[p]).norm(), 64 * eps());
    // |δF| = 110 eps, and the mapping's Lipschitz constant is about 1 for F_E, 2 for F_P.
    within("continuous: F_E", (beside.F_E[p] - once.F_E[p]).norm(), 4 * 64 * 1.8 * eps());
    within("continuous: F_P", (beside.F_P[p] - once.F_P[p]).norm(), 6 * 64 * 1.8 * eps());
    if (p % 3 == 0) {
      within("a material without limits does not yield", (once.F_P[p] - F_P[p]).norm(), 8 * eps());
      continue;
    }
    const verification::Svd usv = verification::svd_oracle(to_matrix(F[p]));
    Real ratio = 1;
    for (const Real s : usv.sigma)
      ratio *= s / std::min<Real>(std::max<Real>(s, 1 - 2.5e-2), 1 + 7.5e-3);
    if (ratio != 1) ++yielded;
    const double J_P = F_P[p].determinant();
    within("J_P is multiplied by Π σ̂_i/σ_i",
           once.F_P[p].determinant() - static_cast<double>(ratio) * J_P,
           128 * eps() * (1 + std::abs(J_P)));
  }
  expect("most particles yield", yielded > static_cast<std::int64_t>(F.size() / 2));
}

}  // namespace
}  // namespace firn::suite
