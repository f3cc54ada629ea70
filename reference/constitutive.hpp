// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The constitutive model: everything that the steps ask of a material. Snow's
/// elasto-plastic energy density (Stomakhin et al. 2013, section 5) is
///
///     Ψ(F_E, F_P) = μ ‖F_E − R_E‖² + λ/2 (J_E − 1)²
///     μ = μ_0 e^{ξ(1−J_P)},  λ = λ_0 e^{ξ(1−J_P)}
///
/// Steps, time step and diagnostics use the functions of a `Material`; those of
/// `Lame`, below, are the formulas that these consist of.

#include <string>

#include "firn/material.hpp"
#include "firn/types.hpp"
#include "reference/svd.hpp"

namespace firn::reference {

/// Ψ [J/m³].
double energy_density(const Material& material, const Mat3& F_E, const Mat3& F_P);

/// Step 3. P F_Eᵀ = ∂Ψ/∂F_E F_Eᵀ [Pa]. Times V_p0 this is V_p σ_p, present volume
/// times Cauchy stress.
Mat3 kirchhoff_stress(const Material& material, const Mat3& F_E, const Mat3& F_P);

/// Why the stress at F_P is not finite: names the hardening where that overflows.
std::string why_not_finite(const Material& material, const Mat3& F_P);

/// c = √((λ + 2μ)/ρ), the speed of compression waves at density `rho` [kg/m³]  [m/s].
double sound_speed(const Material& material, const Mat3& F_P, double rho);

/// Step 7. The part of F̂_E beyond the elastic limits becomes plastic:
///
///     F̂_E = U Σ̂ Vᵀ,   Σ = clamp(Σ̂, [1 − θ_c, 1 + θ_s])
///     F_E = U Σ Vᵀ,    F_P = V Σ⁻¹ Uᵀ F^{n+1},   F^{n+1} = F̂_E F_P
///
/// so that F_E F_P = F^{n+1} still. Where nothing is clamped, F_E = F̂_E and F_P
/// stays as it is, to the last bit.
void return_map(const Material& material, const Mat3& F_E_hat, Mat3& F_E, Mat3& F_P);

/// Hardened Lamé parameters [Pa].
struct Lame {
  double mu;
  double lambda;
};

/// e^{ξ(1−J_P)}, J_P = det F_P: compressed snow is stiffer. May overflow to +∞,
/// which the steps report as an error of the particle.
double hardening(const Material& material, const Mat3& F_P);

/// μ and λ after hardening.
Lame lame(const Material& material, const Mat3& F_P);

/// Ψ [J/m³].
double energy_density(const Lame& lame, const Mat3& F_E);

/// P = ∂Ψ/∂F_E = 2μ(F_E − R_E) + λ(J_E − 1) cof F_E  [Pa], the first
/// Piola–Kirchhoff stress of the elastic part; cof F = J F^{-T}.
Mat3 piola_stress(const Lame& lame, const Mat3& F_E);

/// P F_Eᵀ = 2μ(F_E − R_E) F_Eᵀ + λ(J_E − 1) J_E I  [Pa]. Times V_p0 this is
/// V_p σ_p, present volume times Cauchy stress.
Mat3 kirchhoff_stress(const Lame& lame, const Mat3& F_E);

/// Cofactor matrix: cof F = J F^{-T}, polynomial in F and defined for every F.
/// Its columns are f2×f3, f3×f1, f1×f2.
Mat3 cofactor(const Mat3& F);

/// Derivative of the cofactor matrix at F along dF, also without an inverse.
Mat3 cofactor_differential(const Mat3& F, const Mat3& dF);

/// Step 6. The energy of one particle expanded to second order about F_E: what it
/// takes to apply the Hessian ∂²Ψ/∂F_E² to many directions dF.
class StressDifferential {
 public:
  StressDifferential() = default;
  StressDifferential(const Material& material, const Mat3& F_E, const Mat3& F_P);
  StressDifferential(const Lame& lame, const Mat3& F_E);

  /// dP = ∂²Ψ/∂F_E² : dF = 2μ(dF − dR) + λ C (C : dF) + λ(J_E − 1) dC  [Pa].
  Mat3 operator()(const Mat3& dF) const;

  /// False where the hardening overflows or F_E is not finite.
  bool is_finite() const;

  /// dR, the change of the rotation R_E along dF.
  Mat3 rotation_differential(const Mat3& dF) const;

 private:
  Lame lame_{};
  Mat3 F_, R_, C_;
  Mat3 K_inverse_;  ///< of K = tr(S) I − S
  double J_ = 0;
};

}  // namespace firn::reference
