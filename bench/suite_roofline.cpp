// SPDX-License-Identifier: BSD-3-Clause
/// Machine probes: the ceilings that the rates of the steps are held against.

#include "bench/probes.hpp"
#include "bench/suites.hpp"
#include "firn/machine.hpp"

namespace firn::bench {

namespace {

struct Probe {
  const char *name, *title, *units, *meaning;
  double (*measure)(int threads);
};

constexpr Probe probes[] = {
    {"fma_float", "fused multiply-adds, float", "flop/s", "2 flop per lane and FMA",
     fma_peak_float},
    {"fma_double", "fused multiply-adds, double", "flop/s", "2 flop per lane and FMA",
     fma_peak_double},
    {"triad", "memory, a = b + s c", "B/s", "24 bytes per element; arrays of 256 MB",
     triad_bandwidth},
    {"read", "memory, sum of an array", "B/s", "8 bytes per element; array of 256 MB",
     read_bandwidth},
};

}  // namespace

void plan_roofline_suite(const Registry&, const Options& options, std::vector<CasePlan>& plans) {
  const int most = options.max_threads > 0 ? options.max_threads : available_processors();
  for (const Probe& probe : probes)
    for (int threads = 1; threads <= most; threads *= 2) {
      CasePlan plan;
      plan.description.suite = "roofline";
      plan.description.name = std::string(probe.name) + "," + std::to_string(threads) + "T";
      plan.description.title =
          std::string(probe.title) + ", " + std::to_string(threads) + " threads";
      plan.description.parameters = {{"probe", std::string(probe.name)},
                                     {"threads", static_cast<double>(threads)},
                                     {"instruction_set", instruction_set()}};
      plan.quick = true;
      plan.run = [probe, threads](results::Case& result) {
        results::Quantity rate{
            "rate", probe.units, probe.meaning, results::Quantity::Better::higher, {}, true};
        probe.measure(threads);  // touches the pages, wakes the clock
        for (int i = 0; i < 9; ++i) rate.values.push_back(probe.measure(threads));
        result.quantities.push_back(rate);
      };
      plans.push_back(std::move(plan));
    }
}

}  // namespace firn::bench
