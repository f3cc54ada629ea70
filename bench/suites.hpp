// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What each suite plans; suites.cpp lists them.

#include "bench/bench.hpp"
#include "bench/timing.hpp"

namespace firn::bench {

void plan_roofline_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_steps_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_scaling_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_stages_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_speedup_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_accuracy_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_stability_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_stress_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_float_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_skips_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_kernels_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_implicit_suite(const Registry&, const Options&, std::vector<CasePlan>&);
/// Part of the suite `implicit`.
void plan_iterations(const Registry&, const Options&, const Subject&, std::vector<CasePlan>&);
void plan_snowball_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_targets_suite(const Registry&, const Options&, std::vector<CasePlan>&);

}  // namespace firn::bench
