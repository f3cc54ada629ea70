// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A solver seen in whole steps only.

#include <memory>

#include "firn/solver.hpp"

namespace firn::suite {

/// The same solver, which stops nowhere but at the end of a step: `firn verify --whole-steps`
/// judges by it what can be told about a code that has no other stops.
std::unique_ptr<Solver> in_whole_steps(std::unique_ptr<Solver> solver);

}  // namespace firn::suite
