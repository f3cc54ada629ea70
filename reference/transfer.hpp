// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The transfer: what passes between a particle p and the nodes i around it, in
/// both directions. PIC/FLIP as in Stomakhin et al. 2013, section 4.1; nothing
/// else in the reference knows which transfer this is. All sums over nodes of
/// steps 1, 3, 6, 7 and 8 are here. Scattering adds to the nodes, gathering
/// leaves them as they are.

#include <vector>

#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "reference/stencil.hpp"

namespace firn::reference {

/// Step 1. m_i += m_p w_ip  [kg],  (m v)_i += m_p w_ip v_p  [kg m/s].
void scatter_mass_and_momentum(const Particles& particles, std::size_t p, const Stencils& stencils,
                               std::vector<double>& m, std::vector<Vec3>& momentum);

/// Steps 3 and 6. f_i += A ∇w_ip, the divergence of a stress times volume A [J]  [N].
void scatter_divergence(const Mat3& A, std::size_t p, const Stencils& stencils,
                        std::vector<Vec3>& f);

/// Steps 6 and 7. ∇v_p = Σ_i v_i (∇w_ip)ᵀ  [1/s].
Mat3 gather_gradient(const std::vector<Vec3>& v, std::size_t p, const Stencils& stencils);

/// Step 8. The new velocity of particle p, with the FLIP fraction α  [m/s]:
///
///     v_PIC  = Σ_i v_i^{n+1} w_ip
///     v_FLIP = v_p + Σ_i (v_i^{n+1} − v_i^n) w_ip
///     v_p    = (1 − α) v_PIC + α v_FLIP
void gather_velocity(const Scene& scene, const Grid& grid, std::size_t p, const Stencils& stencils,
                     Particles& particles);

}  // namespace firn::reference
