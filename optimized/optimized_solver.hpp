// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The fast solver: explicit and semi-implicit integration in float or double, on any number
/// of threads.

#include <string>
#include <vector>

#include "firn/registry.hpp"

namespace firn {

/// Entry for a registry. A separate function call, nothing registers itself.
SolverEntry optimized_entry();

std::unique_ptr<Solver> make_optimized_solver(const SolverOptions& options);

/// The instruction set in use: "SSE4", "AVX2", "AVX3" (AVX-512), "NEON", …
/// FIRN_TARGET=sse4, avx2, avx3 or neon in the environment takes a lesser one than the
/// processor's best; InputError if it is unknown or the processor lacks it.
std::string optimized_target_name();

/// The names that FIRN_TARGET may have on this processor, best first.
std::vector<std::string> optimized_targets();

}  // namespace firn
