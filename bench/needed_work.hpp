// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// How much a step has to compute and to move, counted in two ways.

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

/// Share of a peak [flop/s] that a step reaches which takes so many seconds per particle, by the
/// operations that the factored step needs, over the multiply-adds of the peak.
inline double factored_share(Deformation deformation, double seconds, double peak) {
  const NeededWork needed = needed_work(deformation);
  return (needed.to_grid + needed.to_particles) / seconds / (0.5 * peak);
}

/// The plain count [flop; a multiply-add is two]: what the textbook form of the transfers takes
/// per particle and step. At each of 64 nodes w_ip and ∇w_ip are formed from three 1-D factors
/// each: 4 values of 2 products. Then follow multiply-adds: 1 for the mass, 3 for the momentum
/// and 9 for the force τ∇w_ip of the scatter, 6 for the velocities v^n and v^{n+1} and 9 for ∇v
/// of the gather. The weights are formed once for both; the 1-D factors themselves and all that
/// is done once per particle, the update of F above all, is left out. A code that rebuilds its
/// weights in the gather does more than that, one that keeps the products of a row of nodes 5 %
/// less. This is the count to compare codes by: it charges all of them with the same work. By
/// it the share of a factored step says how fast the step is, not how busy the units are.
inline constexpr double plain_flop = 64 * (4 * 2 + 2 * (1 + 3 + 9 + 6 + 9));
static_assert(plain_flop == 4096);  // as the report has it, which draws rooflines by this count

inline double plain_share(double seconds, double peak) { return plain_flop / seconds / peak; }

}  // namespace firn::bench
