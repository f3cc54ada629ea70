// SPDX-License-Identifier: BSD-3-Clause
#include "cli/python.hpp"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/progress.hpp"
#include "firn/error.hpp"
#include "firn/interruption.hpp"

namespace firn::cli {

namespace {

std::string python_interpreter() {
  if (const char* python = std::getenv("FIRN_PYTHON"); python != nullptr && *python != '\0')
    return python;
  return FIRN_PYTHON_DEFAULT;
}

int run_process(std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0)
    throw InputError("firn: cannot start a process: " + std::string(std::strerror(errno)));
  if (child == 0) {
    // Ctrl-C is answered here: Python would print where it was.
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  interruption::set_child(child);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  interruption::set_child(0);
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  throw InputError("firn: " + words[2] + " ended by signal " + std::to_string(WTERMSIG(status)) +
                   " (" + strsignal(WTERMSIG(status)) + "): a file may be damaged: " + words[3]);
}

}  // namespace

int run_python_module(std::vector<std::string> words) {
  const std::string python = python_interpreter();
  words.insert(words.begin(), {python, "-m"});
  const Waiting waiting("making the pages");
  const int status = run_process(words);
  if (status == 127)
    throw InputError("FIRN_PYTHON", "Python interpreter", python,
                     "a python3 with the packages in reports/ and teach/ (./run setup makes one)");
  return status;
}

}  // namespace firn::cli
