// SPDX-License-Identifier: BSD-3-Clause
/// firn verify: the suites are a program of their own, firn-verify, which has the test
/// framework in it; this verb is its name.

#include <filesystem>
#include <string>
#include <unistd.h>
#include <vector>

#include "cli/verbs.hpp"
#include "firn/error.hpp"

namespace firn::cli {

namespace {

/// Replaces this process.
void become_firn_verify(const std::vector<std::string>& arguments) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  std::string program =
      ((error ? std::filesystem::path(".") : self.parent_path()) / "firn-verify").string();
  std::vector<char*> argv{program.data()};
  std::vector<std::string> words = arguments;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  throw InputError("verify", "program of the verification suite", program,
                   "built beside firn (cmake --build --preset release --target firn-verify)");
}

}  // namespace

void add_verify(CLI::App& app, Context&) {
  CLI::App* verb = app.add_subcommand(
      "verify", "runs the verification suite on a solver; see `firn verify --help`");
  // Everything after the verb is for firn-verify, including --help.
  verb->set_help_flag();
  verb->prefix_command();
  verb->callback([verb] { become_firn_verify(verb->remaining()); });
}

}  // namespace firn::cli
