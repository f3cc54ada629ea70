// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Workloads in which one skip of the optimized solver applies, or just does not.

#include <vector>

#include "bench/workload.hpp"

namespace firn::bench {

struct Situation {
  const char* name;
  Workload (*make)(std::uint64_t seed);
};

/// A skip by its name in FIRN_NO_SKIP, situations in which it should save something, and
/// one in which it has nothing to leave out and must cost nothing (none: it always
/// applies, but for the first step).
struct SkipCase {
  const char* skip;
  std::vector<Situation> applies;
  std::vector<Situation> does_not;
};

/// Every skip that the solver has.
const std::vector<SkipCase>& skip_cases();

}  // namespace firn::bench
