// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/conditioning.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "verification/check/roundoff.hpp"

namespace firn::check {

namespace {

/// Σ over permutations of |a||b||c|: what the six terms of a determinant may lose
/// to cancellation, each being rounded relative to itself.
double permanent(const Mat3& F) {
  const Mat3 A = F.cwiseAbs();
  return A(0, 0) * (A(1, 1) * A(2, 2) + A(1, 2) * A(2, 1)) +
         A(0, 1) * (A(1, 0) * A(2, 2) + A(1, 2) * A(2, 0)) +
         A(0, 2) * (A(1, 0) * A(2, 1) + A(1, 1) * A(2, 0));
}

/// ‖cof F‖ = ‖∂ det F/∂F‖.
double cofactor_norm(const Vec3& sigma) {
  return Vec3(sigma[1] * sigma[2], sigma[0] * sigma[2], sigma[0] * sigma[1]).norm();
}

// Two rotations are never further apart than ‖R − R'‖ = 2√2.
constexpr double largest_rotation_error = 2.8284271247461903;

}  // namespace

Vec3 signed_singular_values(const Mat3& F) {
  Vec3 sigma = Eigen::JacobiSVD<Mat3>(F).singularValues();
  if (F.determinant() < 0) sigma[2] = -sigma[2];
  return sigma;
}

Sized kirchhoff_stress(const Material& material, const Mat3& F_E, const Mat3& F_P, double F_E_error,
                       double F_P_error, double eps) {
  const Vec3 sigma = signed_singular_values(F_E);
  const double J = F_E.determinant(), J_P = F_P.determinant();
  // e^{ξ(1−J_P)}: an error of the exponent is a relative error of μ and λ. From F_P − I the
  // determinant is a sum of terms of size 1.
  const double exponent = material.hardening * (1 - J_P);
  const double J_P_error = cofactor_norm(signed_singular_values(F_P)) * F_P_error +
                           6 * eps * std::max(1.0, permanent(F_P));
  const double hardening_error =
      material.hardening * J_P_error + Roundoff::few * eps * (1 + std::abs(exponent));
  const double hardening = std::exp(exponent);
  const double mu = material.mu_0() * hardening, lambda = material.lambda_0() * hardening;

  // The polar factor: ‖δR‖ ≤ 2‖δF‖/(σ2 + σ3) (Higham 2008, theorem 8.9, for
  // rotations), so its roundoff is conditioned by σ1/(σ2 + σ3), too.
  const double gap = std::max(0.0, sigma[1] + sigma[2]);
  const double R_condition = std::max(1.0, 2 * sigma[0] / gap);
  const double R_error = std::min(largest_rotation_error, 2 * F_E_error / gap);
  const double R_roundoff = std::min(largest_rotation_error, Roundoff::stress * eps * R_condition);
  const double strain = (sigma - Vec3::Ones()).norm();  // ‖F − R‖

  Sized tau;
  tau.size = std::abs(2 * mu) * strain * sigma[0] + std::sqrt(3.0) * std::abs(lambda * (J - 1) * J);
  const double J_slope = std::abs(2 * J - 1);  // of (J − 1)J
  const double input = 2 * mu * ((F_E_error + R_error) * sigma[0] + strain * F_E_error) +
                       std::sqrt(3.0) * lambda * J_slope * cofactor_norm(sigma) * F_E_error;
  const double local =
      2 * mu * sigma[0] * std::max(R_roundoff, Roundoff::stress * eps * sigma[0]) +
      3 * lambda * Roundoff::stress * eps * std::max(1.0, J_slope * permanent(F_E));
  tau.error = hardening_error * tau.size + input + local;
  return tau;
}

double spatial_stiffness(const Material& material, const Mat3& F_E, const Mat3& F_P) {
  const Vec3 sigma = signed_singular_values(F_E);
  const double J = F_E.determinant();
  const double hardening = std::exp(material.hardening * (1 - F_P.determinant()));
  // ‖δR‖ ≤ 2‖δF‖/(σ2 + σ3); C F_E^T = J I and ‖δC F_E^T‖ ≤ 2‖cof F‖‖F‖‖∇u‖.
  const double rotation = 2 / std::max(sigma[1] + sigma[2], 1e-300);
  return hardening * (2 * material.mu_0() * (1 + rotation) * sigma[0] * sigma[0] +
                      material.lambda_0() *
                          (3 * J * J + 2 * std::abs(J - 1) * cofactor_norm(sigma) * sigma[0]));
}

ReturnErrors plastic_return(const Material& material, const Mat3& F_hat, double F_hat_error,
                            const Mat3& F_P, double F_P_error, double eps) {
  const Vec3 sigma = signed_singular_values(F_hat);
  const Vec3 clamped = sigma.cwiseMax(material.smallest_elastic_stretch())
                           .cwiseMin(material.largest_elastic_stretch());
  // F ↦ U g(Σ) V^T with g = clamp: its derivative has the divided differences
  // (g_i − g_j)/(σ_i − σ_j) ≤ 1 and (g_i + g_j)/(σ_i + σ_j), the latter above 1
  // where compression is clamped.
  const double gap = std::max(0.0, sigma[1] + sigma[2]);
  const double condition = std::max(1.0, (clamped[1] + clamped[2]) / gap);
  ReturnErrors errors;
  errors.F_E = std::min(
      2 * clamped.norm(),
      condition * F_hat_error + Roundoff::deformation * eps * std::max(1.0, condition * sigma[0]));
  // F_P = F_E⁻¹ F̂_E F_P, first order in each factor. What is rounded is F_P or, in a solver
  // that keeps it so, F_P − I: not less than 1.
  const double inverse = 1 / std::max(std::abs(clamped[2]), eps);
  errors.condition = std::max(condition, inverse * sigma[0]);
  const double F_P_norm = F_P.norm();
  const double F_P_new = inverse * sigma[0] * F_P_norm;
  errors.F_P = inverse * (F_hat_error * F_P_norm + sigma[0] * F_P_error + errors.F_E * F_P_new) +
               Roundoff::deformation * eps * std::max(1.0, F_P_new);
  return errors;
}

}  // namespace firn::check
