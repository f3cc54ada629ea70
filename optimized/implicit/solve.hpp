// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The solve of step 6: MINRES with the operator in float inside an iterative refinement whose
/// residuals are found in double.

#include "optimized/implicit/system.hpp"

namespace firn::optimized {

/// What a solve took.
struct SolveReport {
  enum class Status { converged, not_finite, stagnates, out_of_iterations };
  Status status = Status::converged;
  std::int64_t iterations = 0;
  double residual = 0;      ///< true relative residual at the end
  bool indefinite = false;  ///< negative curvature was met
};

/// Solves B v = v* along the free directions, from v*. On success v_star of memory.motion is the
/// solution; otherwise it keeps v*.
template <class S>
SolveReport solve(const LinearSystem<S>& system, double tolerance, std::int64_t max_iterations);

}  // namespace firn::optimized
