// SPDX-License-Identifier: BSD-3-Clause
#include "reference/steps.hpp"

namespace firn::reference {

/// One time step is these ten lines, in order (Stomakhin et al. 2013, section 4.1).
void run_stage(Stage stage, const Scene& scene, const Stencils& stencils, double dt, State& state,
               IntegrationReport& solve) {
  const double t = state.time;
  Particles& particles = state.particles;
  Grid& grid = state.grid;
  switch (stage) {
    case Stage::rasterize: rasterize(particles, stencils, grid); break;
    case Stage::volumes: volumes(scene, stencils, grid, particles); break;
    case Stage::grid_forces: grid_forces(scene, particles, stencils, grid); break;
    case Stage::grid_velocities: grid_velocities(scene, dt, grid); break;
    case Stage::grid_collisions: grid_collisions(scene, t, grid); break;
    case Stage::integration: solve = integration(scene, particles, stencils, dt, grid); break;
    case Stage::deformation: deformation(scene, stencils, grid, dt, particles); break;
    case Stage::particle_velocities: particle_velocities(scene, stencils, grid, particles); break;
    case Stage::particle_collisions: particle_collisions(scene, t, particles); break;
    case Stage::positions: positions(scene, dt, particles); break;
  }
}

}  // namespace firn::reference
