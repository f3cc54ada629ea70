// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Small scenes for the tests of the reference's steps.

#include "firn/registry.hpp"
#include "reference/reference_solver.hpp"
#include "verification/support/scenes.hpp"
#include "verification/support/snow.hpp"

namespace firn::test {

using fixtures::empty_scene;
using fixtures::particles_at_rest;

inline std::unique_ptr<Solver> make_reference() { return make_reference_solver({}); }

/// Draws matrices column by column.
class Random : public fixtures::Random {
 public:
  using fixtures::Random::RandomOf;
  Mat3 mat3() { return fixtures::Random::mat3().transpose(); }
};

/// n particles strewn over a cube of `cells` cells around the origin, with random masses,
/// velocities and elastic and plastic deformations of a few per cent; volumes are unknown.
inline State random_particles(const Scene& scene, std::size_t n, double cells, std::uint64_t seed) {
  State state = fixtures::random_snow(scene, n, 0.5 * cells * scene.grid.spacing, seed);
  Particles& p = state.particles;
  for (std::size_t i = 0; i < n; ++i) {
    p.V_0[i] = 0;
    p.F_E[i].transposeInPlace();
    p.F_P[i].transposeInPlace();
  }
  return state;
}

}  // namespace firn::test
