#pragma once
/// A program run beside Firn, with a time limit on everything that waits for it.

#include <chrono>
#include <string>
#include <sys/types.h>
#include <vector>

namespace firn::guest {

using Clock = std::chrono::steady_clock;

/// Owns the process: whoever drops it kills it and its children.
class ChildProcess {
 public:
  ChildProcess() = default;

  /// Starts words[0] (looked up on PATH) with `words` as its arguments, in a
  /// process group of its own. Standard output goes to standard error, since
  /// Firn's own output carries data. `channel` (if ≥ 0) stays open in the child
  /// as file descriptor 3. Throws InputError if the program cannot be started.
  ChildProcess(const std::vector<std::string>& words, int channel);
  ~ChildProcess() { kill_group(); }
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;

  bool running() const { return pid_ > 0; }

  /// Waits until it has ended; false when the deadline came first.
  bool wait_until(Clock::time_point deadline);

  /// Ends it at once and forgets it.
  void kill_group();

  /// How it ended: "exit status 1", "killed by signal 11 (Segmentation fault)".
  /// Valid once wait_until() has returned true.
  std::string how_it_ended() const;
  bool succeeded() const;

 private:
  pid_t pid_ = -1;
  int status_ = 0;
};

}  // namespace firn::guest
