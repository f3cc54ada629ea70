/// firn bench: measures, and keeps every repetition.

#include "bench/bench.hpp"

#include <iostream>
#include <memory>

#include "cli/verbs.hpp"

namespace firn::cli {

void add_bench(CLI::App& app, Context& context) {
  std::string suites;
  for (const bench::SuiteEntry& suite : bench::suites())
    suites += "\n  " + suite.name + ": " + suite.description;
  CLI::App* verb = app.add_subcommand(
      "bench", "measures speed, accuracy, stability, and what each skip saves; suites:" + suites);
  auto options = std::make_shared<bench::Options>();
  verb->add_option("SUITE", options->suites, "suites or SUITE/CASE, * for anything (default: all)");
  verb->add_option("-o,--out", options->output, "results; an existing file is completed")
      ->capture_default_str();
  verb->add_flag("--quick", options->quick, "the cases that take under three minutes in all");
  verb->add_flag("--again", options->again,
                 "measure what the results have already, too; a single SUITE/CASE always is");
  verb->add_flag("--list", options->list, "name the cases and measure nothing");
  verb->add_option("--solver", options->solvers, "only these solvers (default: all)");
  verb->add_option("--threads", options->max_threads, "at most so many (default: all processors)")
      ->check(CLI::PositiveNumber);
  verb->add_option("--seed", options->seed, "of everything that is drawn at random")
      ->capture_default_str();
  verb->callback([options, &context] {
    context.exit = bench::run(context.registry, *options, std::cout, std::cerr);
  });
}

}  // namespace firn::cli
