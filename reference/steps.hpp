// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The ten steps of one time step as the paper lists them (Stomakhin et al.
/// 2013, section 4.1), one function and one file each. `scene` holds the
/// parameters; particles and grid are in firn/state.hpp; a stencil is the
/// neighbourhood of a particle on the grid.
///
/// In `grid` these functions keep all nodes within reach of a particle. Nodes of
/// zero mass (a particle exactly two cells away, a weight that underflows) take
/// no part: their velocities and forces stay 0.

#include <cstdint>

#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "reference/stencil.hpp"

namespace firn::reference {

/// Step 1: m_i, v_i.
void rasterize(const Particles& particles, const Stencils& stencils, Grid& grid);

/// Step 2: V_p0 of the particles that have none yet.
void volumes(const Scene& scene, const Stencils& stencils, const Grid& grid, Particles& particles);

/// Step 3: f_i.
void grid_forces(const Scene& scene, const Particles& particles, const Stencils& stencils,
                 Grid& grid);

/// Step 4: v_i*.
void grid_velocities(const Scene& scene, double dt, Grid& grid);

/// Step 5: v_i* after contact at time t.
void grid_collisions(const Scene& scene, double t, Grid& grid);

/// What the solve of step 6 took; all 0 for explicit integration.
struct IntegrationReport {
  std::int64_t iterations = 0;
  double residual = 0;      ///< true relative residual at the end
  bool indefinite = false;  ///< negative curvature was met
};

/// Step 6: v_i^{n+1}.
IntegrationReport integration(const Scene& scene, const Particles& particles,
                              const Stencils& stencils, double dt, Grid& grid);

/// Step 7: F_E, F_P.
void deformation(const Scene& scene, const Stencils& stencils, const Grid& grid, double dt,
                 Particles& particles);

/// Step 8: v_p.
void particle_velocities(const Scene& scene, const Stencils& stencils, const Grid& grid,
                         Particles& particles);

/// Step 9: v_p after contact at time t.
void particle_collisions(const Scene& scene, double t, Particles& particles);

/// Step 10: x_p.
void positions(const Scene& scene, double dt, Particles& particles);

/// Runs one of the ten: the list of the paper (ten_steps.cpp). Before step 1 `stencils` must
/// have been built, and state.grid must have their nodes. `solve` is written by step 6.
void run_stage(Stage stage, const Scene& scene, const Stencils& stencils, double dt, State& state,
               IntegrationReport& solve);

}  // namespace firn::reference
