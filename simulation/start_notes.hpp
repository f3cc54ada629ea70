// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What is odd about a scene at t = 0, though it can be run.

#include <string>
#include <vector>

#include "firn/scene.hpp"

namespace firn {

/// One line each: a body some of whose particles begin inside a collider, with how many and how
/// deep; a body whose particles fill a volume more than 5 % off the one that its mesh
/// encloses. `particles` come from sample_bodies(), with the number of each body's in `counts`.
std::vector<std::string> start_notes(const Scene& scene, const Particles& particles,
                                     const std::vector<std::size_t>& counts);

}  // namespace firn
