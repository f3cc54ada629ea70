// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A program run beside Firn, with a time limit on everything that waits for it.

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

#include "guests/output_relay.hpp"

namespace firn::guest {

using Clock = std::chrono::steady_clock;

/// What the process is to be started with.
struct ChildOptions {
  int channel = -1;              ///< if ≥ 0, open in the child as file descriptor 3
  std::uint64_t most_bytes = 0;  ///< of any file it writes; 0 = no limit
};

/// Owns the process: the destructor kills it and its children.
///
/// The child has a process group of its own and nothing on standard input. What
/// it prints goes to standard error, the first part of it (Firn's own standard
/// output carries data). It leaves no core file, ends with the thread that started
/// it, and the system kills it first when memory runs out.
class ChildProcess {
 public:
  ChildProcess() = default;

  /// Starts words[0] (looked up on PATH) with `words` as its arguments. Throws
  /// InputError if the program cannot be started.
  ChildProcess(const std::vector<std::string>& words, const ChildOptions& options);
  ~ChildProcess() { kill_group(); }
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;

  bool running() const { return pid_ > 0; }

  /// Waits until it has ended; false when the deadline came first.
  bool wait_until(Clock::time_point deadline);

  /// Ends it at once and forgets it.
  void kill_group();

  /// How it ended, "exit status 1" or "killed by signal 11 (Segmentation fault)",
  /// and the last line that it printed. Valid once wait_until() has returned true.
  std::string how_it_ended() const;
  bool succeeded() const { return exit_status() == 0; }
  std::optional<int> exit_status() const;  ///< none if a signal killed it
  /// "" if it printed nothing.
  std::string last_line() const { return output_ ? output_->last_line() : std::string(); }

 private:
  pid_t pid_ = -1;
  int status_ = 0;
  std::unique_ptr<OutputRelay> output_;
};

}  // namespace firn::guest
