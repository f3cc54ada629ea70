// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Which particle belongs to which body.

#include <vector>

#include "firn/scene.hpp"

namespace firn {

/// sample_bodies() of firn/scene.hpp; `counts` becomes the number of particles of every body, which
/// follow each other in scene order.
Particles sample_bodies(const Scene& scene, std::vector<std::size_t>& counts);

}  // namespace firn
