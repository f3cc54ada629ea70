#include "bench/suites.hpp"

namespace firn::bench {

const std::vector<SuiteEntry>& suites() {
  static const std::vector<SuiteEntry> all = {
      {"roofline", "machine probes: FMA peak and memory bandwidth", plan_roofline_suite},
      {"speedup", "each solver against the reference, interleaved", plan_speedup_suite},
      {"stages", "time per particle and stage", plan_stages_suite},
      {"steps", "particle-steps per second over sizes and threads", plan_steps_suite},
  };
  return all;
}

}  // namespace firn::bench
