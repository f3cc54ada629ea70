// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Passes what a guest prints on to standard error, up to a limit.

#include <cstddef>
#include <memory>
#include <string>
#include <thread>

namespace firn::guest {

/// Reads a pipe in a thread of its own, so that a guest that prints much never
/// waits for Firn. The first bytes appear on standard error, the rest is thrown
/// away; the last line is kept for the message of how the guest ended.
class OutputRelay {
 public:
  /// Owns `pipe`, the reading end, from now on.
  explicit OutputRelay(int pipe);
  ~OutputRelay() { stop(); }
  OutputRelay(const OutputRelay&) = delete;
  OutputRelay& operator=(const OutputRelay&) = delete;

  /// Takes what is in the pipe and ends the thread, also if somebody still holds
  /// the other end.
  void stop();

  /// The last line that is not empty, as one line for a message. Valid after stop().
  const std::string& last_line() const { return last_line_; }

 private:
  void run();
  void take(const char* bytes, std::size_t count);

  int pipe_, wake_[2];
  std::size_t shown_ = 0;
  std::string line_, last_line_;
  std::thread thread_;
};

}  // namespace firn::guest
