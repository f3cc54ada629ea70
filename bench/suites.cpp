#include "bench/suites.hpp"

namespace firn::bench {

const std::vector<SuiteEntry>& suites() {
  static const std::vector<SuiteEntry> all = {
      {"roofline", "machine probes: FMA peak and memory bandwidth", plan_roofline_suite},
      {"kernels", "single kernels with Google Benchmark, beside Eigen and GSL", plan_kernels_suite},
      {"speedup", "each solver against the reference, interleaved", plan_speedup_suite},
      {"stages", "time per particle and stage, shares of FMA peak and bandwidth",
       plan_stages_suite},
      {"skips", "what each skip of the optimized solver saves, and where it costs",
       plan_skips_suite},
      {"float", "accuracy of float: creep, small strains, far from the origin, long runs",
       plan_float_suite},
      {"accuracy", "run time against error on exact solutions", plan_accuracy_suite},
      {"implicit", "semi-implicit steps: iterations, cost, when they pay", plan_implicit_suite},
      {"snowball", "bands of a plastic impact over seeds", plan_snowball_suite},
      {"stability", "largest stable time step by bisection, against prediction",
       plan_stability_suite},
      {"stress", "what each solver does where it hurts: degenerate input, overflow, NaN",
       plan_stress_suite},
      {"targets", "the optimized solver on every instruction set of this processor",
       plan_targets_suite},
      {"scaling", "cost per particle over their number, and efficiency of threads",
       plan_scaling_suite},
      {"steps", "particle-steps per second over sizes and threads", plan_steps_suite},
  };
  return all;
}

}  // namespace firn::bench
