// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The state to return to when a step fails.

#include <cstddef>
#include <vector>

#include "firn/scene.hpp"
#include "firn/solver.hpp"
#include "firn/state.hpp"

namespace firn {

/// A state in memory, with what the solver needs to continue from it bit for
/// bit, and the Δt of every step made since. Solvers are deterministic, so
/// loading it and repeating these steps leads to the state before a failed one.
struct LastGoodState {
  State state;
  std::vector<std::byte> restart;
  std::vector<double> dts;

  /// Takes the solver's present state; `step` and `time` are the driver's.
  void take(const Solver& solver, std::int64_t step, double time);

  /// Hands it to the solver, without the steps made since.
  void load_into(Solver& solver, const Scene& scene) const;

  /// … and with them. Throws what the solver throws.
  void repeat_on(Solver& solver, const Scene& scene) const;
};

}  // namespace firn
