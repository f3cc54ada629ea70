// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The program firn-guest, started with a channel to it: what might crash or hang
/// happens there.

#include <cstdint>
#include <string>
#include <vector>

#include "guests/child_process.hpp"
#include "guests/packet.hpp"

namespace firn::guest {

class RunnerProcess {
 public:
  RunnerProcess() = default;

  /// Throws InputError if it cannot be started.
  explicit RunnerProcess(std::vector<std::string> arguments);
  ~RunnerProcess() { stop(); }
  RunnerProcess(RunnerProcess&& other) noexcept;
  RunnerProcess& operator=(RunnerProcess&& other) noexcept;

  bool running() const { return socket_ >= 0; }
  void stop();

  /// The answer to one question. Throws ChannelError. `text` of a failure is in the packet.
  Packet ask(const Packet& question, double seconds, std::uint64_t most_bytes);

  /// "ended: killed by …", "gave no answer within 60 s", "broke the protocol: …"; the
  /// process is stopped.
  std::string what_happened(const ChannelError& error, double seconds);

 private:
  ChildProcess process_;
  int socket_ = -1;
};

/// So many seconds from now; far enough away for any number of them.
Clock::time_point deadline_after(double seconds);

/// The program `firn-guest`: FIRN_GUEST_RUNNER in the environment, else beside this program.
std::string runner_path();

}  // namespace firn::guest
