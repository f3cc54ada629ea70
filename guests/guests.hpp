// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Other people's solvers behind the interface of Firn, each in a process of its own:
/// whatever goes wrong there (a crash, an endless loop, a wrong answer) becomes a
/// SimulationError that names the guest, within a time limit.
///
///     ./libmine.so                                   a shared library, firn/firn_guest.h
///     exec:python3 mine.py {in} {out} {steps}        any command that reads and writes
///     trajectories

#include "firn/registry.hpp"

namespace firn {

/// "exec:COMMAND {in} {out} {steps}".
SolverFamily command_guests();

/// "./LIBRARY.so": any path with a '/', and any name that ends in ".so". A library that cannot
/// be started or lacks the precision is an InputError.
SolverFamily library_guests();

}  // namespace firn
