// SPDX-License-Identifier: BSD-3-Clause
#include "firn/scene.hpp"

#include <cmath>
#include <string>

#include "firn/error.hpp"

namespace firn {

int GridSettings::period_nodes(int axis) const {
  return static_cast<int>(std::lround(periodic[axis] / spacing));
}

Vec3 Scene::wrap(const Vec3& x) const {
  Vec3 wrapped = x;
  for (int axis = 0; axis < 3; ++axis) {
    const double period = grid.periodic[axis];
    if (period <= 0) continue;
    const double low = grid.origin[axis], high = low + period;
    if (x[axis] >= low && x[axis] < high) continue;  // unchanged to the last bit
    wrapped[axis] = x[axis] - period * std::floor((x[axis] - low) / period);
    if (wrapped[axis] < low) wrapped[axis] = low;
    if (wrapped[axis] >= high) wrapped[axis] = low;  // −tiny + period rounds up to period
  }
  return wrapped;
}

void require_consistent(const Scene& scene, const Particles& particles) {
  const std::size_t n = particles.size();
  for_each_field(
      [n](const char*, const auto& array) {
        if (array.size() != n)
          throw InputError("state", "particle arrays of different lengths",
                           std::to_string(array.size()),
                           std::to_string(n) + ", the number of positions");
      },
      particles);
  const auto materials = static_cast<std::int32_t>(scene.materials.size());
  for (const std::int32_t material : particles.material)
    if (material < 0 || material >= materials)
      throw InputError("state", "material of a particle", std::to_string(material),
                       "0 .. " + std::to_string(materials - 1));
}

State initial_state(const Scene& scene) {
  State state;
  state.particles = sample_bodies(scene);
  return state;
}

}  // namespace firn
