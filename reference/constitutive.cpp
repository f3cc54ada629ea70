// SPDX-License-Identifier: BSD-3-Clause
#include "reference/constitutive.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "reference/exp.hpp"
#include "reference/failure.hpp"
#include "reference/polar.hpp"

namespace firn::reference {

double energy_density(const Material& material, const Mat3& F_E, const Mat3& F_P) {
  return energy_density(lame(material, F_P), F_E);
}

Mat3 kirchhoff_stress(const Material& material, const Mat3& F_E, const Mat3& F_P) {
  return kirchhoff_stress(lame(material, F_P), F_E);
}

std::string why_not_finite(const Material& material, const Mat3& F_P) {
  const Lame hardened = lame(material, F_P);
  if (finite(hardened.mu) && finite(hardened.lambda)) return "stress is not finite";
  return "hardening exp(xi (1 - J_P)) is not finite, J_P is " + to_text(F_P.determinant());
}

double sound_speed(const Material& material, const Mat3& F_P, double rho) {
  const Lame hardened = lame(material, F_P);
  return std::sqrt((hardened.lambda + 2 * hardened.mu) / rho);
}

void return_map(const Material& material, const Mat3& F_E_hat, Mat3& F_E, Mat3& F_P) {
  const Svd usv = svd(F_E_hat);
  Vec3 sigma;
  for (int k = 0; k < 3; ++k)
    sigma[k] = std::clamp(usv.sigma[k], material.smallest_elastic_stretch(),
                          material.largest_elastic_stretch());
  F_E = F_E_hat;
  if (sigma == usv.sigma) return;
  const Mat3 F = F_E_hat * F_P;
  F_E = usv.U * sigma.asDiagonal() * usv.V.transpose();
  F_P = usv.V * sigma.cwiseInverse().asDiagonal() * usv.U.transpose() * F;
}

double hardening(const Material& material, const Mat3& F_P) {
  const double J_P = F_P.determinant();
  return exp(material.hardening * (1 - J_P));
}

Lame lame(const Material& material, const Mat3& F_P) {
  const double factor = hardening(material, F_P);
  return {material.mu_0() * factor, material.lambda_0() * factor};
}

double energy_density(const Lame& lame, const Mat3& F_E) {
  // ‖F_E − R_E‖² = ‖U(Σ − I)Vᵀ‖² = Σ (σ_i − 1)²: no cancellation near F_E = R_E
  const Svd usv = svd(F_E);
  const double J_E = F_E.determinant();
  return lame.mu * (usv.sigma - Vec3::Ones()).squaredNorm() +
         0.5 * lame.lambda * (J_E - 1) * (J_E - 1);
}

Mat3 piola_stress(const Lame& lame, const Mat3& F_E) {
  const Mat3 R_E = rotation(F_E);
  const double J_E = F_E.determinant();
  return 2 * lame.mu * (F_E - R_E) + lame.lambda * (J_E - 1) * cofactor(F_E);
}

Mat3 kirchhoff_stress(const Lame& lame, const Mat3& F_E) {
  const Mat3 R_E = rotation(F_E);
  const double J_E = F_E.determinant();
  return 2 * lame.mu * (F_E - R_E) * F_E.transpose() +
         lame.lambda * (J_E - 1) * J_E * Mat3::Identity();
}

Mat3 cofactor(const Mat3& F) {
  Mat3 C;
  C.col(0) = F.col(1).cross(F.col(2));
  C.col(1) = F.col(2).cross(F.col(0));
  C.col(2) = F.col(0).cross(F.col(1));
  return C;
}

Mat3 cofactor_differential(const Mat3& F, const Mat3& dF) {
  Mat3 dC;
  dC.col(0) = dF.col(1).cross(F.col(2)) + F.col(1).cross(dF.col(2));
  dC.col(1) = dF.col(2).cross(F.col(0)) + F.col(2).cross(dF.col(0));
  dC.col(2) = dF.col(0).cross(F.col(1)) + F.col(0).cross(dF.col(1));
  return dC;
}

namespace {

/// 1/(σ_i + σ_j), the eigenvalues of K^{-1}. The sum is 0 where the rotation R_E
/// is not differentiable: an inverted particle with σ_2 = −σ_3, or two singular
/// values of 0. It is kept away from 0 by 1e-8 σ_1, about the square root of the
/// roundoff with which σ is known, so that dR stays finite.
double inverse_of_sum(double sigma_i, double sigma_j, double sigma_1) {
  const double smallest = 1e-8 * sigma_1;
  const double sum = sigma_i + sigma_j;
  if (sigma_1 == 0) return 0;
  return 1 / std::copysign(std::max(std::abs(sum), smallest), sum);
}

}  // namespace

StressDifferential::StressDifferential(const Lame& lame, const Mat3& F_E)
    : lame_(lame), F_(F_E), C_(cofactor(F_E)), J_(F_E.determinant()) {
  const Svd usv = svd(F_E);
  const Vec3& sigma = usv.sigma;
  R_ = usv.U * usv.V.transpose();
  const Vec3 inverse(inverse_of_sum(sigma[1], sigma[2], sigma[0]),
                     inverse_of_sum(sigma[0], sigma[2], sigma[0]),
                     inverse_of_sum(sigma[0], sigma[1], sigma[0]));
  K_inverse_ = usv.V * inverse.asDiagonal() * usv.V.transpose();
}

StressDifferential::StressDifferential(const Material& material, const Mat3& F_E, const Mat3& F_P)
    : StressDifferential(lame(material, F_P), F_E) {}

bool StressDifferential::is_finite() const {
  return finite(lame_.mu) && finite(lame_.lambda) && finite(F_);
}

/// From F = R S:  RᵀdF = (RᵀdR) S + dS.  W = RᵀdR is skew because RᵀR = I, and dS
/// is symmetric; subtracting the transpose leaves
///
///     W S + S W = RᵀdF − dFᵀR.
///
/// Both sides are skew. Write W = [ω]×, the matrix of ω×. Then for symmetric S
/// W S + S W = [(tr(S) I − S) ω]×, so that with K = tr(S) I − S
///
///     K ω = axial(RᵀdF − dFᵀR),    dR = R [ω]×.
///
/// S = V Σ Vᵀ gives K = V diag(σ2+σ3, σ1+σ3, σ1+σ2) Vᵀ, inverted above.
Mat3 StressDifferential::rotation_differential(const Mat3& dF) const {
  const Mat3 X = R_.transpose() * dF;
  const Vec3 axial(X(2, 1) - X(1, 2), X(0, 2) - X(2, 0), X(1, 0) - X(0, 1));
  const Vec3 omega = K_inverse_ * axial;
  Mat3 W;
  W << 0, -omega[2], omega[1],  //
      omega[2], 0, -omega[0],   //
      -omega[1], omega[0], 0;
  return R_ * W;
}

/// Term by term from P = 2μ(F − R) + λ(J − 1) C with dJ = C : dF.
Mat3 StressDifferential::operator()(const Mat3& dF) const {
  const double dJ = C_.cwiseProduct(dF).sum();
  return 2 * lame_.mu * (dF - rotation_differential(dF)) + lame_.lambda * dJ * C_ +
         lame_.lambda * (J_ - 1) * cofactor_differential(F_, dF);
}

}  // namespace firn::reference
