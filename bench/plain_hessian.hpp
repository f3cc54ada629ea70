// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The operator of the semi-implicit update as plain scalar code in double, without blocks or
/// vectors: what the optimized one is measured against.

#include <cstddef>
#include <vector>

#include "firn/scene.hpp"
#include "firn/state.hpp"

namespace firn::bench {

/// (H u)_i = Σ_p V_p0 A_p F_Eᵀ ∇w_ip on a box of nodes. Per particle it keeps the left stretch
/// S = √(F Fᵀ), K⁻¹ = (tr(S) I − S)⁻¹ and three moduli, so that with the velocity gradient L
///   V_p0 A Fᵀ = 2μV_p0 (L S − [ω]×) S + λ(J² + (J−1)J)V_p0 tr(L) I − λ(J−1)J V_p0 Lᵀ,
///   ω = K⁻¹ axial(L S − (L S)ᵀ).
class PlainHessian {
 public:
  /// For scenes with one material.
  PlainHessian(const Scene& scene, const Particles& particles);

  std::size_t nodes() const;
  /// Of a node within reach of a particle: its place in the fields.
  std::size_t place(const NodeIndex& i) const;

  void apply(const std::vector<Vec3>& u, std::vector<Vec3>& Hu) const;

 private:
  struct Particle {
    double x[3];  ///< in units of h from the box's first node
    Mat3 stretch, K_inverse;
    double shear, volume, transposed;
  };

  double inverse_spacing_;
  int first_[3], size_[3];  ///< of the box of nodes
  std::vector<Particle> particles_;
};

}  // namespace firn::bench
