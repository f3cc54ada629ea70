// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// How the program ends after Ctrl-C or SIGTERM: in order if that takes less than a second, else
/// by itself. What is called from a signal handler makes only async-signal-safe calls.

#include <string>
#include <sys/types.h>

namespace firn::interruption {

/// Exit status of an interrupted program.
inline constexpr int exit_status = 130;

/// Whoever can, ends in order now; 0.7 s later the program ends itself. To be called by the
/// handler of the first signal, and end_now() by that of the second.
void end_soon() noexcept;

/// "firn: interrupted" on stderr, and the end.
[[noreturn]] void end_now() noexcept;

/// The end came in order: the timer that end_soon() started is stopped.
void ended_in_order() noexcept;

/// While one lives, a step is under way whose result must not be lost: instead of ending the
/// program, the timer only tells what it waits for.
class StepWorthKeeping {
 public:
  StepWorthKeeping() noexcept;
  ~StepWorthKeeping();
  StepWorthKeeping(const StepWorthKeeping&) = delete;
  StepWorthKeeping& operator=(const StepWorthKeeping&) = delete;
};

/// A process that ends with the program; 0: none.
void set_child(pid_t child) noexcept;

/// A half-written file that is removed if the program ends itself; empty: none. One that is
/// longer than 4 KiB is left where it is.
void set_unfinished_file(const std::string& path) noexcept;

}  // namespace firn::interruption
