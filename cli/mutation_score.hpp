// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// firn verify --mutants: does the suite catch the deliberately wrong solvers?

#include <string>

#include "firn/registry.hpp"

namespace firn::cli {

/// Runs the suite on every mutant, each in a process of its own, and lockstep for the stage it
/// names; prints the table, adds it to the results file unless `results` is empty (`force`: even
/// if another file is there). Exit status.
int run_mutation_score(const Registry& registry, const std::string& results, bool json, bool force);

}  // namespace firn::cli
