// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Errors against motions that are known in closed form (oracles/exact), over h, Δt and α.

#include <string>

#include "verification/oracles/exact/exact.hpp"
#include "verification/studies/subject.hpp"

namespace firn::studies {

using exact::AlphaPolicy;
using exact::ExactProblem;
using MakeProblem = ExactProblem (*)(int cells, double cfl, const AlphaPolicy&);

/// The policies for α that are compared.
inline const AlphaPolicy undamped{"1", 1, false}, usual{"0.95", 0.95, false}, pic{"0", 0, false},
    per_time{"rate", 0, true};

/// exact::vortex with G = 0.15.
ExactProblem vortex_of_15_percent(int cells, double cfl, const AlphaPolicy& policy);

/// Explicit, or semi-implicit with β.
struct Integration {
  bool semi_implicit = false;
  double beta = 0;

  std::string text() const;  ///< "explicit", "implicit 0.5"
  void set(Scene& scene) const;
};

struct ConvergenceRun {
  double error = 0;    ///< ‖u_h − u‖/‖u‖ over the particles at the end
  double seconds = 0;  ///< wall time of the steps alone
};

/// Runs the problem once with `solver`, which `subject` made.
ConvergenceRun run_exact(const Subject& subject, Solver& solver, const ExactProblem& problem);

/// Order of convergence between a resolution and one twice as fine.
double order(double coarse_error, double fine_error);

}  // namespace firn::studies
