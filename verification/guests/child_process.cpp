#include "verification/guests/child_process.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

#include "firn/error.hpp"

namespace firn::guest {

namespace {

constexpr int channel_in_child = 3;

/// In the child, between fork and exec: only async-signal-safe calls.
[[noreturn]] void become(const std::vector<char*>& argv, int channel, int report_errno_to) {
  setpgid(0, 0);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  if (channel >= 0 && channel != channel_in_child) dup2(channel, channel_in_child);
  if (channel == channel_in_child) fcntl(channel, F_SETFD, 0);
  execvp(argv[0], argv.data());
  const int error = errno;
  if (write(report_errno_to, &error, sizeof error) < 0) _exit(126);
  _exit(127);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& words, int channel) {
  std::vector<std::string> copies = words;
  std::vector<char*> argv;
  for (std::string& word : copies) argv.push_back(word.data());
  argv.push_back(nullptr);

  // A pipe that exec closes: what comes through it is the reason why exec failed.
  // Its ends are kept away from descriptor 3, which the child overwrites.
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw InputError(words[0] + ": cannot make a pipe: " + std::strerror(errno));
  const int writer = fcntl(ends[1], F_DUPFD_CLOEXEC, 10);
  close(ends[1]);
  pid_ = fork();
  if (pid_ == 0) become(argv, channel, writer);
  const int fork_error = errno;
  close(writer);
  int error = 0;
  const ssize_t got = pid_ > 0 ? read(ends[0], &error, sizeof error) : 0;
  close(ends[0]);
  if (pid_ < 0)
    throw InputError(words[0] + ": cannot start a process: " + std::strerror(fork_error));
  if (got == static_cast<ssize_t>(sizeof error)) {
    waitpid(pid_, &status_, 0);
    pid_ = -1;
    throw InputError(words[0] + ": cannot be run: " + std::strerror(error));
  }
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), status_(other.status_) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  if (this != &other) {
    kill_group();
    pid_ = std::exchange(other.pid_, -1);
    status_ = other.status_;
  }
  return *this;
}

bool ChildProcess::wait_until(Clock::time_point deadline) {
  if (pid_ <= 0) return true;
  for (auto pause = std::chrono::microseconds(100);;
       pause = std::min(2 * pause, std::chrono::microseconds(20000))) {
    const pid_t ended = waitpid(pid_, &status_, WNOHANG);
    if (ended == pid_) {
      kill(-pid_, SIGKILL);  // what it may have left behind
      pid_ = -1;
      return true;
    }
    if (Clock::now() >= deadline) return false;
    std::this_thread::sleep_for(pause);
  }
}

void ChildProcess::kill_group() {
  if (pid_ <= 0) return;
  kill(-pid_, SIGKILL);
  kill(pid_, SIGKILL);
  while (waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
}

bool ChildProcess::succeeded() const { return WIFEXITED(status_) && WEXITSTATUS(status_) == 0; }

std::string ChildProcess::how_it_ended() const {
  if (WIFEXITED(status_)) return "exit status " + std::to_string(WEXITSTATUS(status_));
  if (WIFSIGNALED(status_)) {
    std::string text = "killed by signal ";
    text += std::to_string(WTERMSIG(status_)) + " (" + strsignal(WTERMSIG(status_)) + ")";
    return text;
  }
  return "still running";
}

}  // namespace firn::guest
