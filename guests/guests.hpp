#pragma once
/// Anybody's solver behind the interface of Firn, in a process of its own:
/// whatever it does there (a crash, an endless loop, a wrong answer) ends as a
/// SimulationError that names the guest, within a time limit.
///
///     ./libmine.so                                   a shared library, firn/firn_guest.h
///     exec:python3 mine.py {in} {out} {steps}        any command that reads and writes
///     trajectories

#include <memory>
#include <string>

#include "firn/registry.hpp"
#include "firn/solver.hpp"

namespace firn {

struct GuestOptions {
  double time_limit = 60;  ///< for each answer of the guest [s], > 0
};

/// True for what names a guest rather than a registered solver: the prefix
/// "exec:", a path with a '/', or the ending ".so".
bool names_a_guest(const std::string& solver);

/// Throws InputError if it cannot be started or says that it lacks the precision.
std::unique_ptr<Solver> make_guest_solver(const std::string& solver, const SolverOptions& options,
                                          const GuestOptions& guest_options = {});

}  // namespace firn
