// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// `firn bench`: what is measured, and how a run of it goes.

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "firn/registry.hpp"
#include "io/results/results.hpp"

namespace firn::bench {

struct Options {
  std::vector<std::string> suites;  ///< empty: all
  std::string output = "results/bench.h5";
  bool quick = false;                ///< the cases marked quick only: under 3 minutes
  bool again = false;                ///< measure what the output has, too, in its place
  bool force = false;                ///< replace an output that is no results file
  bool list = false;                 ///< name the cases and measure nothing
  std::vector<std::string> solvers;  ///< empty: all in the registry
  std::vector<std::string> inputs;   ///< files that these read: `output` is none of them
  double time_limit = 60;            ///< for each answer of a guest [s]
  int max_threads = 0;               ///< 0: as many as the machine has
  std::uint64_t seed = 1;            ///< of everything that is drawn at random
};

/// Asked for between repetitions; true after SIGINT or SIGTERM.
bool interrupted();

/// Thrown by a case that noticed interrupted().
struct Interrupted {};

/// One thing to measure. `run` fills quantities, validation and status; it must be
/// repeatable and take all its randomness from Options::seed.
struct CasePlan {
  results::Case description;  ///< suite, name, title, parameters; `command` is added
  bool quick = false;
  std::function<void(results::Case&)> run;
};

struct SuiteEntry {
  std::string name;
  std::string description;
  std::function<void(const Registry&, const Options&, std::vector<CasePlan>&)> plan;
  /// What a case of the quick set, and what another one, takes on average on two cores of
  /// 2023 [s]; only the announced time left depends on it.
  double usual_seconds_quick = 1, usual_seconds = 1;
};

/// Every suite, in the order in which they are run.
const std::vector<SuiteEntry>& suites();

/// Runs what is asked for and missing in the output, appending each finished case.
/// Results and progress go to `log`, lists to `out`. Returns the exit status:
/// 0 done, 1 a case was invalid or failed, 130 interrupted.
int run(const Registry& registry, const Options& options, std::ostream& out, std::ostream& log);

}  // namespace firn::bench
