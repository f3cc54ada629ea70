// SPDX-License-Identifier: BSD-3-Clause
#include "firn/interruption.hpp"

#include <atomic>
#include <csignal>
#include <cstring>
#include <sys/time.h>
#include <unistd.h>

namespace firn::interruption {

namespace {

constexpr suseconds_t patience = 700000;  // µs

std::atomic<int> steps_to_keep{0};
std::atomic<pid_t> child{0};
std::atomic<bool> has_unfinished_file{false};
char unfinished_file[4096];

void tell(const char* text) {
  const ssize_t written = write(STDERR_FILENO, text, std::strlen(text));
  (void)written;  // there is nobody else to tell
}

extern "C" void on_timer(int /*signal*/) {
  if (steps_to_keep.load() == 0) end_now();
  tell(
      "firn: interrupted: waiting for the step under way; once more ends at once, and the file "
      "then ends with its last frame\n");
}

void set_timer(suseconds_t microseconds) {
  itimerval timer{};
  timer.it_value.tv_usec = microseconds;
  setitimer(ITIMER_REAL, &timer, nullptr);
}

}  // namespace

void end_soon() noexcept {
  std::signal(SIGALRM, on_timer);
  set_timer(patience);
}

void end_now() noexcept {
  if (const pid_t process = child.load(); process > 0) kill(process, SIGKILL);
  if (has_unfinished_file.load()) unlink(unfinished_file);
  tell("firn: interrupted\n");
  _exit(exit_status);
}

void ended_in_order() noexcept { set_timer(0); }

StepWorthKeeping::StepWorthKeeping() noexcept { ++steps_to_keep; }
StepWorthKeeping::~StepWorthKeeping() { --steps_to_keep; }

void set_child(pid_t process) noexcept { child.store(process); }

void set_unfinished_file(const std::string& path) noexcept {
  has_unfinished_file.store(false);
  if (path.empty() || path.size() >= sizeof unfinished_file) return;
  std::memcpy(unfinished_file, path.c_str(), path.size() + 1);
  has_unfinished_file.store(true);
}

}  // namespace firn::interruption
