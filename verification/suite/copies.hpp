// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A lump of snow does what it does, however many others there are and wherever it is: copies of
/// it out of each other's reach are judged by the lump alone, near the grid's origin.

#include <string>
#include <vector>

#include "verification/suite/probes.hpp"

namespace firn::suite {

/// n particles of snow in a cube of `cells` cells (an even number) around the origin, every
/// second of unknown volume; their places are multiples of 2^-bits h. Nodes within reach of them
/// are −cells/2 − 1 … cells/2 + 1 along each axis, neither more nor less.
State small_lump(std::size_t n, int cells, int bits, std::uint64_t seed);

/// A scene for it: the paper's snow, α = 0.95.
Scene lump_scene();

/// The lump at each of `places` [cells]. The copies of a particle follow each other, so that
/// those of a lump are strewn over the whole list.
State copies_of(const State& lump, const std::vector<Vec3>& places);

struct CopyError {
  double in_bounds = 0;  ///< largest error of any number, in units of its bound
  std::int64_t numbers = 0;
  std::string where;
};

/// Particles that began as copies_of(lump, places) and went `steps` steps of dt, against
/// `alone`, the lump after as many.
CopyError compare_copies(const Scene& scene, const State& lump, const State& alone,
                         const std::vector<Vec3>& places, const Particles& copies, int steps,
                         double dt);

}  // namespace firn::suite
