// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The verbs of the program, one file each. add_VERB() declares the verb's
/// options; its callback does the work and leaves the exit status.

#include <CLI/App.hpp>
#include <atomic>

#include "firn/registry.hpp"

namespace firn::cli {

/// Exit statuses, the same everywhere.
enum Exit : int {
  exit_done = 0,          ///< done and passed
  exit_failed = 1,        ///< a check, comparison or verification failed
  exit_bad_input = 2,     ///< invalid input or usage; nothing was written
  exit_simulation = 3,    ///< the simulation failed; the last good state was written
  exit_interrupted = 130  ///< by the user; the last good state was written
};

struct Context {
  Registry registry;
  int exit = exit_done;
  /// Set by SIGINT and SIGTERM. Verbs that see it end in order; others are ended within a second
  /// (firn/interruption.hpp). The second signal ends the program at once.
  std::atomic<bool> stop{false};
};

void add_run(CLI::App& app, Context& context);
void add_check(CLI::App& app, Context& context);
void add_compare(CLI::App& app, Context& context);
void add_verify(CLI::App& app, Context& context);
void add_bench(CLI::App& app, Context& context);
void add_report(CLI::App& app, Context& context);
void add_info(CLI::App& app, Context& context);
void add_scenes(CLI::App& app, Context& context);
void add_solvers(CLI::App& app, Context& context);
void add_teach(CLI::App& app, Context& context);

}  // namespace firn::cli
