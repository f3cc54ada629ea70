// SPDX-License-Identifier: BSD-3-Clause
#include "reference/failure.hpp"
#include "reference/steps.hpp"

namespace firn::reference {

/// Step 4. Grid velocities (Stomakhin et al. 2013, §4.1 step 4):
///
///     v_i* = v_i + Δt (f_i / m_i + g)       [m/s]
///
/// Gravity enters here: it is the body force ρg of the equation of motion.
void grid_velocities(const Scene& scene, double dt, Grid& grid) {
  grid.v_star.assign(grid.size(), Vec3::Zero());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.m[i] == 0) continue;
    grid.v_star[i] = grid.v[i] + dt * (grid.f[i] / grid.m[i] + scene.gravity);
    if (!finite(grid.v_star[i]))
      fail_at_node(Stage::grid_velocities, grid, i, "velocity is not finite");
  }
}

}  // namespace firn::reference
