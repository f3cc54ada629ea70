// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A plastic snowball falls on the ground. It has no formal order of convergence: the study gives
/// bands over seeds, never an order.

#include <array>
#include <map>
#include <vector>

#include "firn/scene.hpp"
#include "verification/studies/subject.hpp"

namespace firn::studies {

/// A ball of 0.3 m, just above the ground, falling at 3 m/s for 0.15 s; h = 0.3 m / resolution.
Scene snowball(int resolution, std::uint64_t seed);

/// Mass on a coarse grid, by cell.
using CoarseMass = std::map<std::array<int, 3>, double>;

struct SnowballOutcome {
  double center = 0;   ///< height of the centre of mass at the end [m]
  double width = 0;    ///< extent along x at the end [m]
  double J_P = 0;      ///< mean det F_P, by mass, at the end
  double contact = 0;  ///< when the momentum leaves free fall by 1 % [s]
  CoarseMass mass;     ///< at the end, in cells of 0.1 m, the same for every resolution
};

SnowballOutcome drop_snowball(const Subject& subject, const Scene& scene);

/// ½ Σ |m − m̄| / Σ m̄ of every outcome, m̄ the mean over all of them: the share of the
/// mass that lies elsewhere than in the mean.
std::vector<double> misplaced(const std::vector<SnowballOutcome>& outcomes);

}  // namespace firn::studies
