// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The solver that a study measures.

#include <functional>
#include <memory>

#include "firn/solver.hpp"

namespace firn::studies {

struct Subject {
  std::function<std::unique_ptr<Solver>()> create;  ///< a fresh one
  Precision precision = Precision::float64;
  /// Called before each step; may throw to end the study. Empty: nothing happens.
  std::function<void()> before_step = {};

  void step(Solver& solver, double dt) const {
    if (before_step) before_step();
    solver.step(dt);
  }
};

}  // namespace firn::studies
