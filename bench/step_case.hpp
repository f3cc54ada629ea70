// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What the cases that time whole steps have in common.

#include "bench/timing.hpp"

namespace firn::bench {

inline constexpr int step_repetitions = 9;

/// A repetition long enough that starting and stopping the threads is below 1 %.
inline constexpr double least_seconds = 0.15;

/// A case of `suite` with its name, title and parameters; `run` is left to be filled.
CasePlan step_case(const std::string& suite, const Subject& subject, Deformation deformation,
                   std::size_t particles, bool quick);

/// A timing in nanoseconds, still without values.
results::Quantity nanoseconds(const std::string& name, const std::string& meaning);

}  // namespace firn::bench
