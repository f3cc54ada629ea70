// SPDX-License-Identifier: BSD-3-Clause
/// firn-verify, the program behind `firn verify`: tests a solver against everything that is
/// known about the method.

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <csignal>
#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/mutation_score.hpp"
#include "cli/options.hpp"
#include "cli/verbs.hpp"
#include "firn/error.hpp"
#include "firn/interruption.hpp"
#include "io/one_line.hpp"
#include "io/output_path.hpp"
#include "io/results/machine_facts.hpp"
#include "io/results/results_file.hpp"
#include "solvers/solvers.hpp"
#include "verification/suite/run.hpp"
#include "verification/suite/subject.hpp"
#include "verification/suite/svd_library.hpp"
#include "verification/suite/whole_steps.hpp"

namespace firn::cli {

namespace {

struct Arguments {
  std::shared_ptr<SolverOption> solver;
  suite::RunOptions run;
  std::string results, svd;
  bool json = false, list = false, mutants = false, force = false, whole_steps = false;
};

suite::Subject subject_of(const Arguments& arguments, const Registry& registry) {
  const SolverOption& option = *arguments.solver;
  suite::Subject subject;
  SolverOption one = option;
  if (one.threads == 0) one.threads = 1;
  subject.solver = one.name;
  subject.precision = one.settings(1).precision;
  subject.threads = one.threads;
  subject.command = "firn verify --solver " + shell_word(one.name);
  if (one.precision != "double") subject.command += " --precision " + one.precision;
  const bool whole_steps = arguments.whole_steps;
  if (whole_steps) subject.command += " --whole-steps";
  subject.create = [one, whole_steps, &registry](int threads) {
    SolverOption with_threads = one;
    with_threads.threads = threads;
    auto solver = with_threads.create(registry, 1);
    return whole_steps ? suite::in_whole_steps(std::move(solver)) : std::move(solver);
  };
  subject.create_reference = [&registry] { return registry.create(reference_name, {}); };
  // A name that is none ends here.
  subject.slow = subject.create(subject.threads)->traits().pace == Pace::process;
  return subject;
}

results::Quantity to_quantity(const suite::Observation::Quantity& q) {
  return {q.name, q.units, q.meaning, results::Quantity::Better::neither, {q.value}, false};
}

void write_results(const std::string& path, const suite::Verdict& verdict, bool force) {
  results::ResultsFile file(path, results::machine_facts(0, instruction_set()),
                            results::comparable_facts(), force);
  std::vector<results::Check> checks;
  for (const suite::Row& row : suite::rows())
    checks.push_back({row.topic, row.test + ": " + row.what, row.largest,
                      row.valid ? "VALID" : "INVALID", suite::command_of(row.topic, row.test)});
  const suite::Subject& subject = suite::subject();
  const std::string who = fmt::format("{}, {}", subject.solver, name(subject.precision));
  file.append_verification(who, subject.command, checks);
  for (const suite::Observation& o : suite::observations()) {
    results::Case result;
    result.suite = o.suite;
    result.name =
        "verify," + subject.solver + "," + std::string(name(subject.precision)) + "," + o.name;
    result.title = o.title;
    result.command = subject.command + " --long";
    result.parameters = o.parameters;
    result.parameters.emplace_back("solver", subject.solver);
    result.parameters.emplace_back("precision", std::string(name(subject.precision)));
    result.parameters.emplace_back("threads", static_cast<double>(subject.threads));
    for (const auto& q : o.quantities) result.quantities.push_back(to_quantity(q));
    file.append(result);
  }
  std::fprintf(stderr, "%s: %zu checks of %s, %s\n", path.c_str(), checks.size(), who.c_str(),
               verdict.valid() ? "VALID" : "INVALID");
}

/// Before hours of tests, not after them.
void require_safe_outputs(const Arguments& arguments) {
  std::vector<std::string> inputs = files_of_solver(arguments.solver->name);
  if (!arguments.svd.empty()) inputs.push_back(arguments.svd);
  const std::pair<std::string, OutputKind> outputs[] = {{arguments.results, OutputKind::results},
                                                        {arguments.run.junit, OutputKind::junit}};
  for (const auto& [path, kind] : outputs) {
    if (path.empty()) continue;
    require_no_input(path, inputs);
    require_replaceable(path, kind, arguments.force);
  }
}

int verify(const Arguments& arguments, const Registry& registry) {
  if (arguments.list) {
    for (const std::string& name : suite::test_names()) fmt::print("{}\n", name);
    return exit_done;
  }
  require_safe_outputs(arguments);
  if (!arguments.svd.empty()) {
    const suite::SvdReport report =
        suite::verify_svd_library(arguments.svd, arguments.solver->time_limit);
    fmt::print("{}", report.table);
    return report.valid ? exit_done : exit_failed;
  }
  if (arguments.mutants)
    return run_mutation_score(registry, arguments.results, arguments.json, arguments.force);
  suite::set_subject(subject_of(arguments, registry));
  const suite::Verdict verdict = suite::run(arguments.run);
  if (verdict.tests.empty())
    throw InputError("--filter", "no test of that name", arguments.run.filter,
                     "patterns like Conservation.* (see --list)");
  if (!arguments.results.empty()) write_results(arguments.results, verdict, arguments.force);
  fmt::print("{}\n", arguments.json ? suite::to_json(verdict) : suite::to_table(verdict));
  return verdict.valid() ? exit_done : exit_failed;
}

/// One line on stderr.
int tell(const char* what, int status) {
  std::fprintf(stderr, "firn: %s\n", one_line(what).c_str());
  return status;
}

int run_program(int argc, char** argv) {
  CLI::App app{
      "Runs the verification suite on a solver and prints a table by topic: how much was "
      "compared,\n"
      "the largest error in units of its bound, VALID or INVALID, and for every failure the "
      "command\n"
      "that repeats it."};
  app.name("firn verify");
  Registry registry;
  register_solvers(registry);
  Arguments arguments;
  arguments.solver = add_solver_option(app, registry, "optimized");
  app.add_option("--filter", arguments.run.filter,
                 "run only these tests: TOPIC.TEST, with * and ? as wildcards, several separated "
                 "by ':'");
  app.add_flag("--whole-steps", arguments.whole_steps,
               "judge whole steps only, as if the solver did not stop between stages");
  app.add_flag("--long", arguments.run.long_studies,
               "also run the long studies of convergence and stability");
  app.add_flag("--fail-fast", arguments.run.fail_fast, "stop at the first failure");
  app.add_flag("--list", arguments.list, "list the tests without running them");
  app.add_option("--junit", arguments.run.junit, "write JUnit XML to this file");
  app.add_option("-o,--out", arguments.results, "add the verdict to this results file (HDF5)");
  add_force_option(app, arguments.force);
  app.add_flag("--json", arguments.json, "print JSON");
  app.add_flag("--mutants", arguments.mutants,
               "run the suite on every deliberately wrong solver and report what catches it");
  app.add_option("--svd", arguments.svd,
                 "test the singular value decomposition of a shared library instead "
                 "(verification/suite/firn_svd.h)");
  app.footer("Exit status: 0 VALID; 1 INVALID; 2 invalid input or usage; 130 interrupted.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return tell((std::string(error.what()) + " (see firn verify --help)").c_str(), exit_bad_input);
  }
  return verify(arguments, registry);
}

}  // namespace
}  // namespace firn::cli

int main(int argc, char** argv) {
  for (const int signal : {SIGINT, SIGTERM})
    std::signal(signal, [](int) { firn::interruption::end_now(); });
  try {
    return firn::cli::run_program(argc, argv);
  } catch (const firn::InputError& error) {
    return firn::cli::tell(error.what(), firn::cli::exit_bad_input);
  } catch (const std::exception& error) {
    return firn::cli::tell(error.what(), firn::cli::exit_simulation);
  }
}
