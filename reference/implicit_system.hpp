// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The linear system of the semi-implicit update, as an operator on node
/// velocities. The derivation stands in step_06_integration.cpp.

#include <vector>

#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "reference/constitutive.hpp"
#include "reference/minres.hpp"
#include "reference/stencil.hpp"

namespace firn::reference {

class ImplicitSystem {
 public:
  /// Linearizes the elastic energy about the present F_E of the particles.
  ImplicitSystem(const Scene& scene, const Particles& particles, const Stencils& stencils,
                 const Grid& grid, double dt);

  /// (H u)_i = Σ_j ∂²Φ/∂x_i∂x_j u_j = Σ_p V_p0 A_p F_Eᵀ ∇w_ip. For a velocity u
  /// in m/s the result is in N/s: minus the rate at which the forces change.
  NodeField hessian(const NodeField& u) const;

  /// (B u)_i = u_i + βΔt²/m_i (H u)_i  [m/s]; 0 at nodes of zero mass.
  NodeField apply(const NodeField& u) const;

  /// P u: the part of u along the directions that contact leaves free.
  NodeField free_part(NodeField u) const;

 private:
  struct Linearization {
    double V_p0;
    Mat3 F_E;
    StressDifferential dP;
  };

  const Stencils& stencils_;
  const Grid& grid_;
  double beta_dt2_;  ///< βΔt² [s²]
  std::vector<Linearization> particles_;
};

}  // namespace firn::reference
