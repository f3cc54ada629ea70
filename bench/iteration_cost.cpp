// SPDX-License-Identifier: BSD-3-Clause
#include "bench/iteration_cost.hpp"

#include <utility>

namespace firn::bench {

double IterationCost::add(const StepCost& coarse, const StepCost& fine, double explicit_seconds,
                          double particles) {
  const double one = (fine.seconds - coarse.seconds) / (fine.iterations - coarse.iterations);
  coarse_.push_back(coarse.iterations);
  fine_.push_back(fine.iterations);
  iteration_.push_back(1e9 * one / particles);
  step_.push_back(1e9 * explicit_seconds / particles);
  ratio_.push_back(one / explicit_seconds);
  return one;
}

void IterationCost::add_setup(double without_iterations, double explicit_seconds) {
  setup_.push_back(without_iterations / explicit_seconds - 1);
}

std::vector<results::Quantity> IterationCost::quantities() const {
  std::vector<results::Quantity> all = {
      cost_quantity("iterations 1e-3", "1", "per step, tolerance 1e-3", false, coarse_),
      cost_quantity("iterations 1e-6", "1", "per step, tolerance 1e-6", false, fine_),
      cost_quantity("iteration", "ns", "one iteration, per particle", false, iteration_),
      cost_quantity("explicit step", "ns", "one explicit step, per particle", false, step_),
      cost_quantity("iteration over explicit step", "1", "one iteration in explicit steps", true,
                    ratio_)};
  if (!setup_.empty())
    all.push_back(cost_quantity("set-up", "1",
                                "what a semi-implicit step takes beside an explicit one if its "
                                "first residual is small enough, in explicit steps",
                                false, setup_));
  return all;
}

results::Quantity cost_quantity(const char* name, const char* units, const char* meaning,
                                bool timed, std::vector<double> values) {
  return {name, units, meaning, results::Quantity::Better::lower, std::move(values), timed};
}

}  // namespace firn::bench
