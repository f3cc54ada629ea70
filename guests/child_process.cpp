// SPDX-License-Identifier: BSD-3-Clause
#include "guests/child_process.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

#include "firn/error.hpp"

namespace firn::guest {

namespace {

constexpr int channel_in_child = 3;

/// Whatever happens to it, the child must not take Firn or the machine along.
void confine(std::uint64_t most_bytes) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  if (most_bytes > 0) {
    const rlimit file_size = {most_bytes, most_bytes};
    setrlimit(RLIMIT_FSIZE, &file_size);
  }
  const int score = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (score >= 0 && write(score, "1000", 4) < 0) close(score);
}

/// In the child, between fork and exec: only async-signal-safe calls.
[[noreturn]] void become(const std::vector<char*>& argv, const ChildOptions& options, int output,
                         int report_errno_to) {
  confine(options.most_bytes);
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  dup2(nothing, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  if (options.channel >= 0 && options.channel != channel_in_child)
    dup2(options.channel, channel_in_child);
  if (options.channel == channel_in_child) fcntl(options.channel, F_SETFD, 0);
  signal(SIGPIPE, SIG_DFL);
  execvp(argv[0], argv.data());
  const int error = errno;
  if (write(report_errno_to, &error, sizeof error) < 0) _exit(126);
  _exit(127);
}

struct Pipe {
  int reader = -1, writer = -1;
};

/// Both ends are closed by exec, and kept away from descriptor 3, which the child
/// overwrites.
Pipe make_pipe(const std::string& program) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw InputError(program + ": cannot make a pipe: " + std::strerror(errno));
  const Pipe pipe = {fcntl(ends[0], F_DUPFD_CLOEXEC, 10), fcntl(ends[1], F_DUPFD_CLOEXEC, 10)};
  close(ends[0]);
  close(ends[1]);
  if (pipe.reader < 0 || pipe.writer < 0)
    throw InputError(program + ": cannot make a pipe: " + std::strerror(errno));
  return pipe;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& words, const ChildOptions& options) {
  std::vector<std::string> copies = words;
  std::vector<char*> argv;
  for (std::string& word : copies) argv.push_back(word.data());
  argv.push_back(nullptr);

  // Through the first pipe comes the reason why exec failed, or nothing.
  const Pipe failure = make_pipe(words[0]), output = make_pipe(words[0]);
  pid_ = fork();
  if (pid_ == 0) become(argv, options, output.writer, failure.writer);
  const int fork_error = errno;
  close(failure.writer);
  close(output.writer);
  output_ = std::make_unique<OutputRelay>(output.reader);
  int error = 0;
  const ssize_t got = pid_ > 0 ? read(failure.reader, &error, sizeof error) : 0;
  close(failure.reader);
  if (pid_ < 0)
    throw InputError(words[0] + ": cannot start a process: " + std::strerror(fork_error));
  if (got == static_cast<ssize_t>(sizeof error)) {
    waitpid(pid_, &status_, 0);
    pid_ = -1;
    throw InputError(words[0] + ": cannot be run: " + std::strerror(error));
  }
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      status_(other.status_),
      output_(std::move(other.output_)) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  if (this != &other) {
    kill_group();
    pid_ = std::exchange(other.pid_, -1);
    status_ = other.status_;
    output_ = std::move(other.output_);
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
      output_->stop();
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

std::optional<int> ChildProcess::exit_status() const {
  if (!WIFEXITED(status_)) return {};
  return WEXITSTATUS(status_);
}

std::string ChildProcess::how_it_ended() const {
  std::string text;
  if (WIFEXITED(status_)) {
    text = "exit status ";
    text += std::to_string(WEXITSTATUS(status_));
  } else {
    text = "killed by signal ";
    text += std::to_string(WTERMSIG(status_)) + " (" + strsignal(WTERMSIG(status_)) + ")";
  }
  if (!last_line().empty()) text += ", last line of output: " + last_line();
  return text;
}

}  // namespace firn::guest
