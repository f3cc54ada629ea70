#pragma once
/// How much a step has to compute and to move, whoever does it.

#include "bench/workload.hpp"

namespace firn::bench {

/// Per particle, lane operations (a fused multiply-add, an addition or a product each count
/// once) of the factored cubic kernel, whose row of 4 nodes takes 4 operations per value and
/// 9 per value and derivative: 16 rows for 4 values of mass and momentum and 3 of force; 16
/// rows of 3 velocities with gradient and 3 without. The return map takes about 450 (elastic:
/// 160). And the values of its state that are read and written.
struct NeededWork {
  double to_grid, to_particles, values;
};

inline NeededWork needed_work(Deformation deformation) {
  const bool elastic = deformation == Deformation::elastic;
  const double to_grid = 16 * (4 * 5 + 3 * 10);
  const double to_particles = 16 * (3 * 8 + 3 * 4);
  // read x, v, τ, m; read x, v, F_E, stiffness; write x, v, F_E, τ; and F_P and stiffness.
  return {to_grid, to_particles + (elastic ? 160 : 450), 13.0 + 16 + 21 + (elastic ? 0 : 20)};
}

}  // namespace firn::bench
