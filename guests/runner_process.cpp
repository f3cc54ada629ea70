// SPDX-License-Identifier: BSD-3-Clause
#include "guests/runner_process.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

#include "firn/error.hpp"

namespace firn::guest {

Clock::time_point deadline_after(double seconds) {
  constexpr double longest = 1e9;  // 30 years: no overflow of the clock's count
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(
                            std::chrono::duration<double>(std::min(seconds, longest)));
}

std::string runner_path() {
  if (const char* path = std::getenv("FIRN_GUEST_RUNNER"); path != nullptr && *path != '\0')
    return path;
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  return (error ? std::filesystem::path(".") : self.parent_path()) / "firn-guest";
}

RunnerProcess::RunnerProcess(std::vector<std::string> arguments) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw InputError("--solver", "socket pair", std::strerror(errno), "room for two descriptors");
  arguments.insert(arguments.begin(), runner_path());
  ChildOptions options;
  options.channel = ends[1];
  try {
    process_ = ChildProcess(arguments, options);
  } catch (...) {
    close(ends[0]);
    close(ends[1]);
    throw;
  }
  close(ends[1]);
  socket_ = ends[0];
}

RunnerProcess::RunnerProcess(RunnerProcess&& other) noexcept
    : process_(std::move(other.process_)), socket_(std::exchange(other.socket_, -1)) {}

RunnerProcess& RunnerProcess::operator=(RunnerProcess&& other) noexcept {
  if (this != &other) {
    stop();
    process_ = std::move(other.process_);
    socket_ = std::exchange(other.socket_, -1);
  }
  return *this;
}

void RunnerProcess::stop() {
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
  process_.kill_group();
}

Packet RunnerProcess::ask(const Packet& question, double seconds, std::uint64_t most_bytes) {
  const Clock::time_point deadline = deadline_after(seconds);
  send(socket_, question, deadline);
  Packet answer = receive(socket_, deadline, most_bytes);
  if (answer.kind != Kind::answer && answer.kind != Kind::failure)
    throw ChannelError(ChannelError::Reason::malformed, "an answer of unknown kind");
  return answer;
}

std::string RunnerProcess::what_happened(const ChannelError& error, double seconds) {
  std::string text;
  if (error.reason == ChannelError::Reason::timeout)
    text = "gave no answer within " + to_text(seconds) + " s";
  else if (error.reason == ChannelError::Reason::closed && process_.wait_until(deadline_after(5)))
    text = "ended: " + process_.how_it_ended();
  else
    text = std::string("broke the protocol: ") + error.what();
  stop();
  return text;
}

}  // namespace firn::guest
