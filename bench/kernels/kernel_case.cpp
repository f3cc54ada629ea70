// SPDX-License-Identifier: BSD-3-Clause
#include "bench/kernels/kernel_case.hpp"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cctype>
#include <cstdlib>

#include "firn/error.hpp"
#include "optimized/optimized_solver.hpp"
#include "optimized/target.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

/// Keeps the time of every repetition and prints nothing.
class Collector : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Iteration)
        seconds.push_back(run.real_accumulated_time / static_cast<double>(run.iterations));
  }
  std::vector<double> seconds;
};

void initialize_once() {
  static const bool done = [] {
    static char program[] = "firn";
    char* arguments[] = {program, nullptr};
    int number = 1;
    benchmark::Initialize(&number, arguments);
    return true;
  }();
  (void)done;
}

/// An exception must not cross Google Benchmark's loop.
void time_with(const std::function<void(benchmark::State&)>& loop, std::int64_t iterations,
               std::size_t items, results::Case& result) {
  initialize_once();
  benchmark::ClearRegisteredBenchmarks();
  std::string problem;
  auto* entry = benchmark::RegisterBenchmark("kernel", [&](benchmark::State& state) {
    try {
      loop(state);
    } catch (const std::exception& error) {
      problem = error.what();
      state.SkipWithError(problem.c_str());
    }
  });
  entry->Repetitions(9);
  if (iterations > 0)
    entry->Iterations(iterations)->UseManualTime();
  else
    entry->MinTime(0.02)->UseRealTime();
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector, nullptr, "kernel");
  if (!problem.empty()) throw std::runtime_error(problem);
  Quantity time{"time", "ns", "wall time per item", Quantity::Better::lower, {}, true};
  for (const double seconds : collector.seconds)
    time.values.push_back(1e9 * seconds / static_cast<double>(items));
  result.quantities = {time};
}

}  // namespace

void plan_kernel(const std::string& kernel, const std::string& code, const std::string& precision,
                 const std::string& target, std::function<void(results::Case&)> run,
                 std::vector<CasePlan>& plans) {
  CasePlan plan;
  results::Case& d = plan.description;
  d.suite = "kernels";
  d.name = kernel + "," + code + "," + precision + (target.empty() ? "" : "," + target);
  d.title = d.name;
  d.parameters = {{"kernel", kernel}, {"code", code}, {"precision", precision}};
  if (!target.empty()) d.parameters.emplace_back("target", target);
  // The best instruction set is part of the quick set.
  plan.quick = target.empty() || target == kernel_targets().front();
  plan.run = [run = std::move(run), target](results::Case& result) {
    const TargetScope scope(target);
    run(result);
  };
  plans.push_back(std::move(plan));
}

bool judge(results::Case& result, const std::string& what, double worst, double allowed) {
  result.validation = what + ": " + to_text(worst) + " eps, allowed " + to_text(allowed);
  if (worst <= allowed) return true;
  result.status = results::Status::invalid;
  result.message = result.validation;
  return false;
}

void time_body(const std::function<void()>& body, std::size_t items, results::Case& result) {
  time_with(
      [&](benchmark::State& state) {
        for ([[maybe_unused]] auto once : state) {
          body();
          benchmark::ClobberMemory();
        }
      },
      0, items, result);
}

void time_part(const std::function<double()>& seconds, std::size_t items, results::Case& result) {
  // What does not count may take far longer than what does: few iterations, chosen here.
  seconds();
  const double once = seconds();
  const auto iterations = static_cast<std::int64_t>(std::clamp(0.002 / once, 2.0, 16.0));
  time_with(
      [&](benchmark::State& state) {
        for ([[maybe_unused]] auto turn : state) state.SetIterationTime(seconds());
      },
      iterations, items, result);
}

TargetScope::TargetScope(const std::string& target) {
  if (const char* old = std::getenv("FIRN_TARGET")) before_ = old, had_ = true;
  if (!target.empty()) setenv("FIRN_TARGET", target.c_str(), 1);
  optimized::select_target_from_environment();
}

TargetScope::~TargetScope() {
  if (had_)
    setenv("FIRN_TARGET", before_.c_str(), 1);
  else
    unsetenv("FIRN_TARGET");
  optimized::select_target_from_environment();
}

std::vector<std::string> kernel_targets() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    // FIRN_TARGET in the environment of `firn bench` limits all that is measured.
    if (const char* only = std::getenv("FIRN_TARGET"); only != nullptr && *only != '\0')
      all.push_back(only);
    else
      all = optimized_targets();
    for (std::string& name : all)
      std::transform(name.begin(), name.end(), name.begin(),
                     [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return all;
  }();
  return names;
}

}  // namespace firn::bench
