// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Blocks of snow of a chosen size in which, by construction, every particle stays
/// elastic or every particle yields in every step.

#include <cstdint>
#include <string>

#include "firn/scene.hpp"

namespace firn::bench {

enum class Deformation { elastic, plastic };
std::string name(Deformation deformation);

struct Workload {
  Scene scene;
  State state;
  int steps_allowed = 0;  ///< how long the promise holds after loading `state`
};

/// About `particles` particles, 8 per cell, jittered, in a cube; the paper's snow,
/// α = 0.95, explicit, exact volumes. The cube drifts by 1 % of h per step, so
/// that some 3 % of the particles change cell, and deforms uniformly:
/// F_E = diag(s)·Q with a random rotation Q of each particle, ∇v = diag(1, −½, −½) r.
/// Elastic: s in the middle of the box, rΔt = 1e-6. Plastic: s in the corner
/// (1+θ_s, 1−θ_c, 1−θ_c), rΔt = 5e-4, so that all three singular values are
/// clamped. Δt = 1 µs: sound travels 2e-5 of a spacing per step, so neither the
/// surface nor the noise of the forces changes the picture within steps_allowed.
Workload block(std::size_t particles, Deformation deformation, std::uint64_t seed);

}  // namespace firn::bench
