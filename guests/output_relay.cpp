// SPDX-License-Identifier: BSD-3-Clause
#include "guests/output_relay.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "io/one_line.hpp"

namespace firn::guest {

namespace {

constexpr std::size_t most_shown = 16384;   // bytes on standard error for each process
constexpr std::size_t longest_line = 200;   // kept for messages
constexpr int most_reads_at_the_end = 256;  // a pipe holds 64 KiB; somebody may still be filling it

}  // namespace

OutputRelay::OutputRelay(int pipe) : pipe_(pipe) {
  fcntl(pipe_, F_SETFL, O_NONBLOCK);
  if (pipe2(wake_, O_CLOEXEC) != 0) wake_[0] = wake_[1] = -1;  // poll passes over −1
  thread_ = std::thread([this] { run(); });
}

void OutputRelay::stop() {
  if (!thread_.joinable()) return;
  close(wake_[1]);
  thread_.join();
  close(wake_[0]);
  close(pipe_);
  if (!line_.empty()) take("\n", 1);
}

void OutputRelay::run() {
  char bytes[4096];
  for (int reads_left = most_reads_at_the_end; reads_left > 0;) {
    pollfd items[2] = {{pipe_, POLLIN, 0}, {wake_[0], POLLIN, 0}};
    if (poll(items, 2, -1) < 0 && errno != EINTR) return;
    const bool stopping = items[1].revents != 0;
    const ssize_t got = read(pipe_, bytes, sizeof bytes);
    if (got > 0) take(bytes, static_cast<std::size_t>(got));
    if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) return;
    if (stopping && got < 0) return;
    if (stopping) --reads_left;
  }
}

void OutputRelay::take(const char* bytes, std::size_t count) {
  if (shown_ < most_shown) {
    const std::size_t more = std::min(count, most_shown - shown_);
    std::fwrite(bytes, 1, more, stderr);
    shown_ += more;
    if (shown_ == most_shown) std::fputs("\n(further output of this guest is not shown)\n", stderr);
  }
  for (const char* at = bytes; at != bytes + count; ++at) {
    if (*at != '\n') {
      if (line_.size() < longest_line) line_ += *at;
      continue;
    }
    if (line_.find_first_not_of(" \t\r") != std::string::npos) last_line_ = one_line(line_);
    line_.clear();
  }
}

}  // namespace firn::guest
