#include "guests/guests.hpp"

#include <cmath>

#include "firn/error.hpp"
#include "guests/command_solver.hpp"
#include "guests/library_solver.hpp"

namespace firn {

namespace {

constexpr const char* command_prefix = "exec:";

bool is_command(const std::string& solver) { return solver.rfind(command_prefix, 0) == 0; }

}  // namespace

bool names_a_guest(const std::string& solver) {
  const bool ends_in_so = solver.size() > 3 && solver.compare(solver.size() - 3, 3, ".so") == 0;
  return is_command(solver) || ends_in_so || solver.find('/') != std::string::npos;
}

std::unique_ptr<Solver> make_guest_solver(const std::string& solver, const SolverOptions& options,
                                          const GuestOptions& guest_options) {
  if (!(guest_options.time_limit > 0) || !std::isfinite(guest_options.time_limit))
    throw InputError("--time-limit", "seconds for an answer of a guest",
                     to_text(guest_options.time_limit), "above 0");
  if (is_command(solver))
    return std::make_unique<guest::CommandSolver>(solver.substr(std::string(command_prefix).size()),
                                                  options, guest_options);
  return std::make_unique<guest::LibrarySolver>(solver, options, guest_options);
}

}  // namespace firn
