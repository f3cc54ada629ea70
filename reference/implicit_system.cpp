// SPDX-License-Identifier: BSD-3-Clause
#include "reference/implicit_system.hpp"

#include "reference/failure.hpp"
#include "reference/transfer.hpp"

namespace firn::reference {

ImplicitSystem::ImplicitSystem(const Scene& scene, const Particles& particles,
                               const Stencils& stencils, const Grid& grid, double dt)
    : stencils_(stencils), grid_(grid), beta_dt2_(scene.integrator.implicitness * dt * dt) {
  particles_.reserve(particles.size());
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Material& material = scene.materials[static_cast<std::size_t>(particles.material[p])];
    const Mat3& F_E = particles.F_E[p];
    const double V_p0 = particles.V_0[p];
    const StressDifferential dP(material, F_E, particles.F_P[p]);
    if (!dP.is_finite() || !finite(V_p0))
      fail_at_particle(Stage::integration, p, "stiffness is not finite");
    particles_.push_back({V_p0, F_E, dP});
  }
}

NodeField ImplicitSystem::hessian(const NodeField& u) const {
  NodeField Hu(u.size(), Vec3::Zero());
  for (std::size_t p = 0; p < particles_.size(); ++p) {
    const auto& [V_p0, F_E, dP] = particles_[p];
    const Mat3 grad_u_p = gather_gradient(u, p, stencils_);
    const Mat3 A_p = dP(grad_u_p * F_E);
    scatter_divergence(V_p0 * A_p * F_E.transpose(), p, stencils_, Hu);
  }
  return Hu;
}

NodeField ImplicitSystem::apply(const NodeField& u) const {
  NodeField Bu = hessian(u);
  for (std::size_t i = 0; i < u.size(); ++i)
    Bu[i] = grid_.m[i] > 0 ? Vec3(u[i] + beta_dt2_ * Bu[i] / grid_.m[i]) : Vec3(Vec3::Zero());
  return Bu;
}

NodeField ImplicitSystem::free_part(NodeField u) const {
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = grid_.free_directions[i] * u[i];
  return u;
}

}  // namespace firn::reference
