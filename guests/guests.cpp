// SPDX-License-Identifier: BSD-3-Clause
#include "guests/guests.hpp"

#include <cmath>

#include "firn/error.hpp"
#include "guests/command_solver.hpp"
#include "guests/library_solver.hpp"

namespace firn {

namespace {

const std::string command_prefix = "exec:";

void require_time_limit(const SolverOptions& options) {
  if (!(options.time_limit > 0) || !std::isfinite(options.time_limit))
    throw InputError("--time-limit", "seconds for an answer of a guest",
                     to_text(options.time_limit), "above 0");
}

}  // namespace

SolverFamily command_guests() {
  return {"exec:COMMAND {in} {out} {steps}", "a command that reads and writes trajectories",
          begins_with(command_prefix), [](const std::string& name, const SolverOptions& options) {
            require_time_limit(options);
            return std::make_unique<guest::CommandSolver>(name.substr(command_prefix.size()),
                                                          options);
          }};
}

SolverFamily library_guests() {
  const auto is_library = [](const std::string& name) {
    const bool ends_in_so = name.size() > 3 && name.ends_with(".so");
    return ends_in_so || name.find('/') != std::string::npos;
  };
  return {"./LIBRARY.so", "a shared library with the C ABI of firn/firn_guest.h", is_library,
          [](const std::string& name, const SolverOptions& options) {
            require_time_limit(options);
            return std::make_unique<guest::LibrarySolver>(name, options);
          }};
}

}  // namespace firn
