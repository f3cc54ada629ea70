// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What a semi-implicit step costs, from steps at two tolerances and explicit ones beside them.

#include <vector>

#include "bench/suites.hpp"

namespace firn::bench {

/// Of one step.
struct StepCost {
  double seconds = 0, iterations = 0;
};

class IterationCost {
 public:
  /// Semi-implicit steps to 1e-3 and 1e-6 and an explicit one, taken in turn with `particles`
  /// each. What the former two differ by is the cost of their further iterations. Returns the
  /// seconds of one iteration.
  double add(const StepCost& coarse, const StepCost& fine, double explicit_seconds,
             double particles);

  /// A semi-implicit step without an iteration, and an explicit one.
  void add_setup(double without_iterations, double explicit_seconds);

  std::vector<results::Quantity> quantities() const;

 private:
  std::vector<double> coarse_, fine_, iteration_, step_, ratio_, setup_;
};

/// A quantity of which less is better; a `timed` one decides whether its case is noisy.
results::Quantity cost_quantity(const char* name, const char* units, const char* meaning,
                                bool timed, std::vector<double> values = {});

}  // namespace firn::bench
