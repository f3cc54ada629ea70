// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The machine and the build that figures belong to, and how noisy it is just now.

#include <cstdint>
#include <string>
#include <vector>

#include "io/results/results.hpp"

namespace firn::bench {

/// Processor, caches, memory, frequency, load, compiler, flags, instruction set,
/// commit. Those in `comparable_facts()` must agree within one results file.
results::Facts machine_facts(std::uint64_t seed);
const std::vector<std::string>& comparable_facts();

/// Seconds that a fixed chain of dependent multiply-adds takes (about 2 ms): the
/// same work every time, so that its spread is the machine's noise.
double calibration_loop();

}  // namespace firn::bench
