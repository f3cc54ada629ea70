// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Small random states of snow in which every stage has work to do, and every plausible
/// mistake shows: two materials, particles of different masses, known and unknown volumes,
/// colliders that move and turn, a grid whose origin is not zero, particles on both sides of
/// it. The same bits on every machine.

#include <string>
#include <vector>

#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "verification/support/snow.hpp"

namespace firn::fixtures {

struct Case {
  std::string name;
  Scene scene;
  State state;
  int steps = 2;  ///< for how many the method itself bears the state
};

/// Slides over a moving plane with friction and into a sticky, turning sphere.
Case lump_on_slope();

/// The same with a step of 1 ms, five times what explicit steps bear, β = 0.8.
Case implicit_lump();

/// In a domain that is periodic along x, with an adaptive time step that hardened snow limits.
Case periodic_lump();

/// Particles on nodes, faces and edges of cells and a bit beside them, coincident, alone, far
/// away; F_E inverted, singular, a pure rotation, crushed and stretched; F_P hard and soft.
Case awkward_lump();

/// The lump on the slope 20 000 cells from the world's origin, with a grid whose origin is there,
/// too.
Case far_lump();

/// Those near the origin: all but far_lump().
std::vector<Case> snow_cases();

}  // namespace firn::fixtures
