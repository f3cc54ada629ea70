// SPDX-License-Identifier: BSD-3-Clause
/// firn report: hands over to the Python package in reports/, which reads HDF5 and nothing else.

#include <filesystem>
#include <optional>
#include <vector>

#include "cli/options.hpp"
#include "cli/python.hpp"
#include "cli/verbs.hpp"
#include "firn/error.hpp"

namespace firn::cli {

namespace {

struct ReportArguments {
  std::string file, baseline, out, errors;
  std::optional<double> threshold;
  bool readme_table = false, force = false;
  std::vector<std::string> checks;
};

int run_report(const ReportArguments& arguments) {
  if (!std::filesystem::exists(arguments.file))
    throw InputError(arguments.file, "results or trajectory", "no such file",
                     "an HDF5 file of firn");
  std::vector<std::string> words = {"firn_reports", arguments.file, "-o", arguments.out};
  for (const std::string& check : arguments.checks) words.insert(words.end(), {"--check", check});
  if (!arguments.errors.empty()) words.insert(words.end(), {"--errors", arguments.errors});
  if (!arguments.baseline.empty()) words.insert(words.end(), {"--baseline", arguments.baseline});
  if (const auto& share = arguments.threshold) {
    if (!(*share > 0 && *share < 1e300))
      throw InputError("--threshold", "fraction", to_text(*share), "finite, above 0");
    words.insert(words.end(), {"--threshold", to_text(*share)});
  }
  if (arguments.readme_table) words.push_back("--readme-table");
  if (arguments.force) words.push_back("--force");
  return run_python_module(words);
}

}  // namespace

void add_report(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(
      "report",
      "makes one self-contained HTML page from the results of `bench` or a trajectory of `run`");
  auto arguments = std::make_shared<ReportArguments>();
  arguments->out = "report";
  verb->add_option("RESULTS", arguments->file, "results (.h5) or trajectory (.vtkhdf)")->required();
  verb->add_option("--baseline", arguments->baseline,
                   "results of an earlier run; exit 1 if a case became slower");
  verb->add_option("--threshold", arguments->threshold,
                   "with --baseline: a case may be slower by up to this fraction (default: 0.1)");
  verb->add_flag("--readme-table", arguments->readme_table,
                 "print a summary of the results as Markdown instead of making a page");
  verb->add_option("--check", arguments->checks,
                   "output of `firn check --json` to show on the page; may be repeated");
  verb->add_option("--errors", arguments->errors,
                   "what `firn check --dump` wrote: adds histograms and a map of the errors");
  verb->add_option("-o,--out", arguments->out, "folder for the page")->capture_default_str();
  add_force_option(*verb, arguments->force);
  verb->callback([arguments, &context] { context.exit = run_report(*arguments); });
}

}  // namespace firn::cli
