// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Small scenes that use every feature, for the suites of the optimized solver.

#include <cstdint>
#include <memory>

#include "firn/registry.hpp"
#include "firn/scene.hpp"
#include "firn/solver.hpp"

namespace firn::test {

/// Two snowballs of different snow, about 1500 particles each, that hit each
/// other, a turning cylinder, a sticky wall and a floor with friction.
Scene collision_of_everything();

/// Snow in a box that is periodic along all axes, with periods that are (4, 8, 12) or
/// are not (5, 9, 7) multiples of a block.
Scene periodic_snow(bool multiple_of_four);

/// Weightless: a ball flies into a block that rests, undeformed, beside a wall without
/// friction, which it is pushed along. One material.
Scene block_at_rest();

/// A state some steps on, reached by the solver itself: moving, deformed and yielding.
State advanced(const Scene& scene, int steps);

std::unique_ptr<Solver> optimized(Precision precision, int threads = 1);

/// Every bit of particles and grid.
bool same_bits(const State& a, const State& b);

}  // namespace firn::test
