// SPDX-License-Identifier: BSD-3-Clause
/// Body forces of the exact problems, by way of the grid.

#include <array>
#include <cmath>
#include <vector>

#include "verification/oracles/exact/exact.hpp"

namespace firn::exact {

namespace {

/// The nodes of a fully periodic grid, and the cubic B-spline weights of a point on them.
class PeriodicGrid {
 public:
  explicit PeriodicGrid(const GridSettings& grid) : grid_(grid) {
    for (int axis = 0; axis < 3; ++axis) nodes_[axis] = grid.period_nodes(axis);
  }

  std::size_t size() const {
    return static_cast<std::size_t>(nodes_[0]) * static_cast<std::size_t>(nodes_[1]) *
           static_cast<std::size_t>(nodes_[2]);
  }

  /// visit(i, w_ip) for the 64 nodes around x.
  template <class Visit>
  void for_each_node(const Vec3& x, Visit&& visit) const {
    std::array<std::size_t, 4> node[3];
    std::array<double, 4> N[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double at = (x[axis] - grid_.origin[axis]) / grid_.spacing, cell = std::floor(at);
      const double t = at - cell, r = 1 - t;
      N[axis] = {r * r * r / 6, (0.5 * t - 1) * t * t + 2.0 / 3, (0.5 * r - 1) * r * r + 2.0 / 3,
                 t * t * t / 6};
      const int n = nodes_[axis];
      const int first = static_cast<int>(cell) - 1;
      for (int a = 0; a < 4; ++a)
        node[axis][static_cast<std::size_t>(a)] =
            static_cast<std::size_t>(((first + a) % n + n) % n);
    }
    const auto rows = static_cast<std::size_t>(nodes_[1]),
               row = static_cast<std::size_t>(nodes_[2]);
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        for (std::size_t c = 0; c < 4; ++c)
          visit((node[0][a] * rows + node[1][b]) * row + node[2][c], N[0][a] * N[1][b] * N[2][c]);
  }

 private:
  const GridSettings& grid_;
  int nodes_[3];
};

}  // namespace

void ExactProblem::push(State& state) const {
  if (!body_force) return;
  const double dt = scene.time.step;
  const PeriodicGrid grid(scene.grid);
  Particles& p = state.particles;
  std::vector<double> m(grid.size(), 0.0);
  std::vector<Vec3> f(grid.size(), Vec3::Zero());
  for (std::size_t at = 0; at < p.size(); ++at) {
    const Vec3 force = p.m[at] * body_force(X[at], state.time);
    grid.for_each_node(p.x[at], [&](std::size_t i, double w) {
      m[i] += w * p.m[at];
      f[i] += w * force;
    });
  }
  for (std::size_t at = 0; at < p.size(); ++at)
    grid.for_each_node(p.x[at], [&](std::size_t i, double w) {
      if (m[i] > 0) p.v[at] += dt * w * f[i] / m[i];
    });
}

}  // namespace firn::exact
