// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The row that every step adds to /firn/diagnostics.

#include <cstdint>

#include "firn/scene.hpp"
#include "firn/state.hpp"

namespace firn {

struct Diagnostics {
  double time = 0;                       ///< [s]
  double dt = 0;                         ///< Δt of the step that led here [s]
  double mass = 0;                       ///< [kg]
  Vec3 momentum = Vec3::Zero();          ///< Σ m_p v_p [kg m/s]
  Vec3 angular_momentum = Vec3::Zero();  ///< Σ x_p × m_p v_p about the world origin [kg m²/s]
  double kinetic_energy = 0;             ///< Σ ½ m_p ‖v_p‖² [J]
  double elastic_energy = 0;             ///< Σ V_p0 Ψ(F_E, F_P) [J]
  double gravitational_energy = 0;       ///< −Σ m_p g·x_p [J]
  Vec3 center_of_mass = Vec3::Zero();    ///< [m]
  double max_speed = 0;                  ///< [m/s]
  double min_J_E = 0, max_J_E = 0;       ///< det F_E [1]
  std::int64_t grid_nodes = 0;           ///< nodes of positive mass in that step
  std::int64_t solver_iterations = 0;    ///< of the semi-implicit solve
};

/// Measures `state` in a plain loop, with Eigen's SVD for the energy: the
/// default of Solver::diagnostics(), and an oracle for solvers that have their
/// own. `grid_nodes`, `dt` and `solver_iterations` are left to the caller.
Diagnostics measure(const Scene& scene, const State& state);

}  // namespace firn
