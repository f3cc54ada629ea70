// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The machine and the build that figures and verdicts belong to.

#include <cstdint>
#include <string>
#include <vector>

#include "io/results/results.hpp"

namespace firn::results {

/// Processor, caches, memory, frequency, load, compiler, flags, commit, and the instruction set
/// that the caller used. Those in `comparable_facts()` must agree within one results file.
Facts machine_facts(std::uint64_t seed, const std::string& instruction_set);
const std::vector<std::string>& comparable_facts();

}  // namespace firn::results
