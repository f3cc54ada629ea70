// SPDX-License-Identifier: BSD-3-Clause
/// firn bench: measures, and keeps every repetition.

#include "bench/bench.hpp"

#include <iostream>
#include <memory>

#include "cli/options.hpp"
#include "cli/verbs.hpp"

namespace firn::cli {

void add_bench(CLI::App& app, Context& context) {
  std::string suites;
  for (const bench::SuiteEntry& suite : bench::suites())
    suites += "\n  " + suite.name + ": " + suite.description;
  CLI::App* verb =
      app.add_subcommand("bench", "measures speed, accuracy and stability; suites:" + suites);
  auto options = std::make_shared<bench::Options>();
  verb->add_option("SUITE", options->suites,
                   "suites or SUITE/CASE, with * as wildcard (default: all)");
  verb->add_option("-o,--out", options->output,
                   "results file; if it exists, missing cases are added to it")
      ->capture_default_str();
  verb->add_flag("--quick", options->quick, "only the quick cases: less than three minutes in all");
  verb->add_flag("--again", options->again,
                 "measure again what the file already has; a case named as SUITE/CASE is always "
                 "measured");
  verb->add_flag("--list", options->list, "list the cases without measuring them");
  verb->add_option("--solver", options->solvers, "only these solvers (default: all)");
  verb->add_option("--time-limit", options->time_limit,
                   "seconds that a library or command may take for one answer")
      ->capture_default_str();
  verb->add_option("--threads", options->max_threads,
                   "use at most this many threads (default: all processors)")
      ->check(CLI::PositiveNumber);
  verb->add_option("--seed", options->seed, "seed of all random numbers")->capture_default_str();
  add_force_option(*verb, options->force);
  verb->callback([options, &context] {
    for (const std::string& solver : options->solvers)
      for (const std::string& file : files_of_solver(solver)) options->inputs.push_back(file);
    context.exit = bench::run(context.registry, *options, std::cout, std::cerr);
  });
}

}  // namespace firn::cli
