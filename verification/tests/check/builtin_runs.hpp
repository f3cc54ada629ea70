// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Every registered solver in every precision against the reference, in lockstep, on
/// every built-in scene that it supports.

#include <gtest/gtest.h>
#include <string>

#include "io/scene/builtin_scenes.hpp"
#include "io/scene/scene_file.hpp"
#include "verification/check/check.hpp"
#include "verification/tests/check/solvers.hpp"

namespace firn::test {
struct Run {
  std::string scene, solver;
  Precision precision;
};

inline std::vector<Run> all_runs() {
  std::vector<Run> runs;
  for (const BuiltinScene& scene : builtin_scenes())
    for (const SolverEntry& entry : builtin_registry().entries())
      for (const Precision precision : entry.precisions)
        if (entry.name != "reference")
          runs.push_back({std::string(scene.name), entry.name, precision});
  return runs;
}

inline std::string run_name(const testing::TestParamInfo<Run>& info) {
  return info.param.scene + "_" + info.param.solver + "_" + std::string(name(info.param.precision));
}

inline void expect_valid(const Run& run, const CheckOptions& options) {
  const Scene scene = find_scene(run.scene);
  if (scene.semi_implicit() && !builtin_registry().traits(run.solver).semi_implicit)
    GTEST_SKIP() << run.solver << " has no semi-implicit integration";
  const auto reference = make_reference();
  SolverOptions solver_options;
  solver_options.precision = run.precision;
  const auto subject = builtin_registry().create(run.solver, solver_options);
  const CheckReport report = run_check(scene, *reference, *subject, options);
  EXPECT_TRUE(report.valid()) << to_table(report);
  EXPECT_EQ(report.steps, options.steps);
  EXPECT_GT(report.compared(), 0);
}

}  // namespace firn::test
