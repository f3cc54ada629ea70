// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Random snow: the one generator of random particles.

#include <cstdint>

#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "verification/support/random.hpp"

namespace firn::fixtures {

/// Orthogonal, determinant 1.
Mat3 random_rotation(Random& random);

/// Around what values, and how widely, random particles are spread.
struct Snow {
  Vec3 velocity = Vec3::Zero();
  double velocity_spread = 1;                   ///< [m/s] along each axis
  double strain = 0.02, plastic_strain = 0.05;  ///< of the entries of F_E and F_P
};

/// Particle i but for its place: an eighth of a cell of snow, half as much to half as much again,
/// with a known volume.
void random_particle(Random& random, double h, Particles& particles, std::size_t i,
                     const Snow& snow = {});

/// n particles strewn over the cube of this half width [m] around the grid's origin.
State random_snow(const Scene& scene, std::size_t n, double half_width, std::uint64_t seed,
                  const Snow& snow = {});

}  // namespace firn::fixtures
