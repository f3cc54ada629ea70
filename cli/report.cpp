/// firn report: hands over to the Python package in reports/, which reads HDF5 and nothing else.

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "cli/verbs.hpp"
#include "firn/error.hpp"

namespace firn::cli {

namespace {

struct Arguments {
  std::string file, baseline, out;
  std::vector<std::string> checks;
};

/// FIRN_PYTHON in the environment, else the interpreter that the build was told of.
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
    throw InputError("firn report: cannot start a process: " + std::string(std::strerror(errno)));
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

int run_report(const Arguments& arguments) {
  if (!std::filesystem::exists(arguments.file))
    throw InputError(arguments.file, "results or trajectory", "no such file",
                     "an HDF5 file of firn");
  const std::string python = python_interpreter();
  std::vector<std::string> words = {python,         "-m", "firn_reports",
                                    arguments.file, "-o", arguments.out};
  for (const std::string& check : arguments.checks) words.insert(words.end(), {"--check", check});
  if (!arguments.baseline.empty()) words.insert(words.end(), {"--baseline", arguments.baseline});
  const int status = run_process(words);
  if (status == 127)
    throw InputError("FIRN_PYTHON", "Python interpreter", python,
                     "a python3 with the package in reports/ (./run setup makes one)");
  return status;
}

}  // namespace

void add_report(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(
      "report",
      "one self-contained HTML page from the results of `bench` or a trajectory of `run`");
  auto arguments = std::make_shared<Arguments>();
  arguments->out = "report";
  verb->add_option("RESULTS", arguments->file, "results (.h5) or trajectory (.vtkhdf)")->required();
  verb->add_option("--baseline", arguments->baseline,
                   "older results; exit 1 if something became slower");
  verb->add_option("--check", arguments->checks,
                   "output of `firn check --json` to show on the page");
  verb->add_option("-o,--out", arguments->out, "folder of the page")->capture_default_str();
  verb->callback([arguments, &context] { context.exit = run_report(*arguments); });
}

}  // namespace firn::cli
