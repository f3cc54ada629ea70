// SPDX-License-Identifier: BSD-3-Clause
#include "bench/suites.hpp"

namespace firn::bench {

const std::vector<SuiteEntry>& suites() {
  static const std::vector<SuiteEntry> all = {
      {"roofline", "machine probes: FMA peak and memory bandwidth", plan_roofline_suite, 0.3, 0.3},
      {"kernels", "single kernels with Google Benchmark, beside Eigen and GSL", plan_kernels_suite,
       0.4, 0.4},
      {"speedup", "each solver against the reference, interleaved", plan_speedup_suite, 2.8, 3},
      {"steps", "particle-steps per second over sizes and threads", plan_steps_suite, 1.7, 7},
      {"stages", "time per particle and stage, shares of FMA peak and bandwidth", plan_stages_suite,
       3.4, 5},
      {"skips", "what each skip of the optimized solver saves, and where it costs",
       plan_skips_suite, 2.4, 2.4},
      {"float", "accuracy of float: creep, small strains, far from the origin, long runs",
       plan_float_suite, 0.5, 4},
      {"accuracy", "run time against error on exact solutions", plan_accuracy_suite, 0.4, 2.6},
      {"implicit", "semi-implicit steps: iterations, cost, when they pay", plan_implicit_suite, 1,
       2.5},
      {"snowball", "bands of a plastic impact over seeds", plan_snowball_suite, 0.7, 9},
      {"stability", "largest stable time step by bisection, against prediction",
       plan_stability_suite, 0.6, 4.3},
      {"stress", "hard cases: degenerate input, overflow, NaN", plan_stress_suite, 0.02, 0.02},
      {"targets", "the optimized solver on every instruction set of this processor",
       plan_targets_suite, 2.6, 2.6},
      {"scaling", "cost per particle over their number, and efficiency of threads",
       plan_scaling_suite, 3, 9},
  };
  return all;
}

}  // namespace firn::bench
