// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What float costs in accuracy: creeping motion, small strain rates, distance from the origin,
/// drift against the reference. Each measures a number that is 0 in exact arithmetic; the caller
/// gives the snow.

#include <utility>
#include <vector>

#include "firn/scene.hpp"
#include "verification/studies/subject.hpp"

namespace firn::studies {

/// Undeformed particles that all move at v, for `steps` of the scene's Δt: their mean displacement
/// along each axis over `distance`, less the exact 1, 0 along axes of v = 0.
Vec3 creep(const Subject& subject, const Scene& scene, State state, const Vec3& v, int steps,
           double distance);

/// A cube of undeformed snow, stretched along x: relative error of the strain after `steps` of the
/// scene's Δt, averaged over the particles within `half_width` of the middle.
struct Stretch {
  int cells = 12;  ///< along an edge
  Vec3 corner = Vec3::Zero();
  double rate = 1e-3;     ///< ∂v_x/∂x [1/s]
  double half_width = 0;  ///< [m]
  int steps = 200;
};
double small_strain(const Subject& subject, const Scene& scene, const Stretch& stretch);

/// Largest ‖ΔF_E‖ after 100 steps between a cloud and the same cloud `distance` [m] away along
/// every axis. Both hold few enough digits that adding the distance rounds nothing away; the
/// cloud is scaled to h = 1/16 m for that.
double far_away(const Subject& subject, Scene scene, State state, double distance);

/// RMS velocity difference to `reference` over the RMS velocity, after 10, 30, … 1000 steps from
/// the same state.
std::vector<std::pair<int, double>> drift(const Subject& subject, Solver& reference,
                                          const Scene& scene, const State& state);

}  // namespace firn::studies
