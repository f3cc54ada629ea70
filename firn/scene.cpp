#include "firn/scene.hpp"

#include <cmath>

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

State initial_state(const Scene& scene) {
  State state;
  state.particles = sample_bodies(scene);
  return state;
}

}  // namespace firn
