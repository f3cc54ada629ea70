// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What `firn check` compares if no scene is given: a few small states in which every stage has
/// work to do, and in which every mutant that a check can catch shows.

#include <string>
#include <vector>

#include "verification/check/check.hpp"

namespace firn::studies {

struct StandardCase {
  std::string name;  ///< as `firn check NAME` takes it: "lump_on_a_slope"
  Scene scene;
  std::vector<CheckWindow> windows;
};

/// Found by smallest_set() and held by the test StandardSet.*.
std::vector<StandardCase> standard_set();

/// Every case that the set may be made of.
std::vector<StandardCase> candidates();

/// Indices of the fewest rows of `catches` that have together every column that any row has
/// (catches[c][m]: case c catches mistake m); of several such sets the first in order.
std::vector<std::size_t> smallest_set(const std::vector<std::vector<bool>>& catches);

}  // namespace firn::studies
