// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Condition numbers of the two matrix functions of the method: the stress of
/// step 3 and the plastic return of step 7.

#include "firn/material.hpp"
#include "firn/types.hpp"

namespace firn::check {

/// A quantity's norm and the bound of its error.
struct Sized {
  double size = 0, error = 0;
};

/// σ1 ≥ σ2 ≥ |σ3|, the sign of det F on σ3.
Vec3 signed_singular_values(const Mat3& F);

/// τ = 2μ(F_E − R_E)F_E^T + λ(J_E − 1)J_E I with μ, λ hardened by e^{ξ(1−J_P)},
/// Frobenius norm [Pa], for Frobenius errors of F_E and F_P.
Sized kirchhoff_stress(const Material& material, const Mat3& F_E, const Mat3& F_P, double F_E_error,
                       double F_P_error, double eps);

/// Bound of ‖A F_E^T‖/‖∇u‖ with A = 2μ(δF − δR) + λ(C:δF)C + λ(J−1)δC, δF = ∇u F_E [Pa].
double spatial_stiffness(const Material& material, const Mat3& F_E, const Mat3& F_P);

/// Errors of F_E = U clamp(Σ̂) V^T and F_P = F_E⁻¹ F̂_E F_P.
struct ReturnErrors {
  double F_E = 0, F_P = 0;
  double condition = 1;  ///< by which errors of F̂_E grow, the larger of the two fields'
};
ReturnErrors plastic_return(const Material& material, const Mat3& F_hat, double F_hat_error,
                            const Mat3& F_P, double F_P_error, double eps);

}  // namespace firn::check
