#include <Eigen/LU>
#include <algorithm>

#include "reference/failure.hpp"
#include "reference/steps.hpp"
#include "reference/svd.hpp"

namespace firn::reference {

namespace {

/// The part of F̂_E beyond the elastic limits becomes plastic:
///
///     F̂_E = U Σ̂ Vᵀ,   Σ = clamp(Σ̂, [1 − θ_c, 1 + θ_s])
///     F_E = U Σ Vᵀ,    F_P = V Σ⁻¹ Uᵀ F^{n+1}
///
/// so that F_E F_P = F^{n+1} still. Where nothing is clamped, F_E = F̂_E and F_P
/// stays as it is, to the last bit.
void return_to_elastic_limits(const Material& material, const Mat3& F_E_hat, Mat3& F_E, Mat3& F_P) {
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

}  // namespace

/// Step 7. Deformation gradient (Stomakhin et al. 2013, §4.1 step 7):
///
///     ∇v_p = Σ_i v_i^{n+1} (∇w_ip)ᵀ         [1/s]
///     F̂_E = (I + Δt ∇v_p) F_E,   F^{n+1} = F̂_E F_P
///
/// First all the change is taken to be elastic; then the return mapping above.
void deformation(const Scene& scene, const Stencils& stencils, const Grid& grid, double dt,
                 Particles& particles) {
  for (std::size_t p = 0; p < particles.size(); ++p) {
    Mat3 grad_v_p = Mat3::Zero();
    stencils.for_each_node_with_gradient(p, [&](std::size_t i, double, const Vec3& grad_w_ip) {
      grad_v_p += grid.v_new[i] * grad_w_ip.transpose();
    });
    const Mat3 F_E_hat = (Mat3::Identity() + dt * grad_v_p) * particles.F_E[p];
    const Material& material = scene.materials[static_cast<std::size_t>(particles.material[p])];
    return_to_elastic_limits(material, F_E_hat, particles.F_E[p], particles.F_P[p]);
    if (!finite(particles.F_E[p]) || !finite(particles.F_P[p]))
      fail_at_particle(Stage::deformation, p, "deformation gradient is not finite");
  }
}

}  // namespace firn::reference
