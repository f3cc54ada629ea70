// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Snow as the paper parameterizes it.

#include <string>

namespace firn {

/// Constitutive parameters of one material (Stomakhin et al. 2013, section 5 and table 2).
struct Material {
  std::string name;
  double youngs_modulus = 1.4e5;         ///< E_0 [Pa], > 0
  double poisson_ratio = 0.2;            ///< ν [1], in (−1, ½)
  double density = 400.0;                ///< ρ_0 of the undeformed snow [kg/m³], > 0
  double hardening = 10.0;               ///< ξ [1], ≥ 0
  double critical_compression = 2.5e-2;  ///< θ_c [1], in (0, 1); infinity with θ_s: purely elastic
  double critical_stretch = 7.5e-3;      ///< θ_s [1], > 0

  /// μ_0 = E_0 / (2(1+ν)), the initial shear modulus [Pa].
  double mu_0() const { return youngs_modulus / (2 * (1 + poisson_ratio)); }

  /// λ_0 = E_0 ν / ((1+ν)(1−2ν)), the initial first Lamé parameter [Pa].
  double lambda_0() const {
    return youngs_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
  }

  /// Limits of the elastic singular values, [1−θ_c, 1+θ_s]; infinite θ: no limit.
  double smallest_elastic_stretch() const { return 1 - critical_compression; }
  double largest_elastic_stretch() const { return 1 + critical_stretch; }
};

}  // namespace firn
