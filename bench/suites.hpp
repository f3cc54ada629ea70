#pragma once
/// What each suite plans; suites.cpp lists them.

#include "bench/bench.hpp"

namespace firn::bench {

void plan_roofline_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_steps_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_stages_suite(const Registry&, const Options&, std::vector<CasePlan>&);
void plan_speedup_suite(const Registry&, const Options&, std::vector<CasePlan>&);

}  // namespace firn::bench
