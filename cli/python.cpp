// SPDX-License-Identifier: BSD-3-Clause
#include "cli/python.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sys/wait.h>
#include <unistd.h>

#include "firn/error.hpp"

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
    execvp(argv[0], argv.data());
    _exit(127);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  return 128 + WTERMSIG(status);
}

}  // namespace

int run_python_module(std::vector<std::string> words) {
  const std::string python = python_interpreter();
  words.insert(words.begin(), {python, "-m"});
  const int status = run_process(words);
  if (status == 127)
    throw InputError("FIRN_PYTHON", "Python interpreter", python,
                     "a python3 with the packages in reports/ and teach/ (./run setup makes one)");
  return status;
}

}  // namespace firn::cli
