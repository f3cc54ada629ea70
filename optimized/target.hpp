// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Which instruction set the kernels use.

#include <string>
#include <vector>

namespace firn::optimized {

/// Makes `name` ("sse4", "avx2", "avx3", "neon"; "" for the best) the instruction
/// set of kernels that are asked for from now on. Not while a solver is being made
/// on another thread. InputError if the processor or the build lacks it.
void select_target(const std::string& name);

/// The names that the kernels carry which are dispatched now, of explicit steps and of the
/// semi-implicit solve, in float and double: all alike, or something is wrong.
std::vector<std::string> dispatched_targets();

/// As FIRN_TARGET says; called by every new solver.
void select_target_from_environment();

}  // namespace firn::optimized
