// SPDX-License-Identifier: BSD-3-Clause
/// firn: simulate, check, compare and measure material point codes for snow.

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <unistd.h>

#include "cli/verbs.hpp"
#include "firn/build_info.hpp"
#include "firn/error.hpp"
#include "firn/interruption.hpp"
#include "io/hdf5/reading.hpp"
#include "io/one_line.hpp"
#include "solvers/solvers.hpp"

namespace {

firn::cli::Context* signal_context = nullptr;

extern "C" void on_second_signal(int /*signal*/) { firn::interruption::end_now(); }

/// First signal: finish the step, write the last good state; whoever cannot, is ended soon.
extern "C" void on_signal(int /*signal*/) {
  signal_context->stop.store(true);
  std::signal(SIGINT, on_second_signal);
  std::signal(SIGTERM, on_second_signal);
  firn::interruption::end_soon();
}

void write_text(const char* text) {
  if (write(STDERR_FILENO, text, std::strlen(text)) < 0) _exit(firn::cli::exit_bad_input);
}

/// A crash inside HDF5 is the file's: one line, exit 2. Any other is our own.
extern "C" void on_crash(int signal) {
  if (const char* file = firn::hdf5::file_being_read()) {
    write_text("firn: ");
    write_text(file);
    write_text(": is damaged: HDF5 crashes on it\n");
    _exit(firn::cli::exit_bad_input);
  }
  std::signal(signal, SIG_DFL);
  raise(signal);
}

/// On a stack of its own, for the crash may be that the stack has no room left.
void handle_crashes() {
  static char stack[1 << 16];
  stack_t other = {};
  other.ss_sp = stack;
  other.ss_size = sizeof stack;
  sigaltstack(&other, nullptr);
  struct sigaction action = {};
  action.sa_handler = on_crash;
  action.sa_flags = SA_ONSTACK | SA_NODEFER;
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
    sigaction(signal, &action, nullptr);
}

/// One line, whatever the text and its bytes.
void print_error(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  while (!text.empty() && text.back() == ' ') text.pop_back();
  std::fprintf(stderr, "firn: %s\n", firn::one_line(text).c_str());
}

/// What CLI11 says, or which word is no verb.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
  std::string text = error.what();
  const std::vector<std::string> extra = app.remaining();
  if (app.get_subcommands().empty() && !extra.empty()) {
    text = "verb: unknown: got ";
    text += extra.front() + ", allowed:";
    for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
      text += " " + verb->get_name();
  }
  return text + " (see firn --help)";
}

int run_program(int argc, char** argv, firn::cli::Context& context) {
  using namespace firn::cli;
  CLI::App app{
      "Verification and benchmark harness for snow simulation with the material point method."};
  app.name("firn");
  app.set_version_flag("--version", "firn " + firn::build_info().version);
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 done and passed; 1 a check, comparison or verification failed; 2 invalid "
      "input\n"
      "or usage, nothing written; 3 the simulation failed, last good state written; 130 "
      "interrupted,\n"
      "last good state written.  SCENE is a file or a name that `firn scenes` prints.");
  add_run(app, context);
  add_check(app, context);
  add_compare(app, context);
  add_verify(app, context);
  add_bench(app, context);
  add_report(app, context);
  add_teach(app, context);
  add_info(app, context);
  add_scenes(app, context);
  add_solvers(app, context);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);  // --help, --version
  } catch (const CLI::ParseError& error) {
    print_error(usage_error(app, error));
    return exit_bad_input;
  }
  return context.exit;
}

}  // namespace

int main(int argc, char** argv) {
  firn::cli::Context context;
  signal_context = &context;
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(SIGPIPE, SIG_DFL);
  handle_crashes();
  try {
    firn::register_solvers(context.registry);
    const int status = run_program(argc, argv, context);
    firn::interruption::ended_in_order();
    if (status == firn::cli::exit_interrupted) print_error("interrupted");
    return status;
  } catch (const firn::InputError& error) {
    print_error(error.what());
    return firn::cli::exit_bad_input;
  } catch (const firn::SimulationError& error) {
    print_error(error.what());
    return firn::cli::exit_simulation;
  } catch (const std::bad_alloc&) {
    print_error("out of memory");
    return firn::cli::exit_simulation;
  } catch (const std::exception& error) {
    print_error(std::string("internal error: ") + error.what());
    return firn::cli::exit_simulation;
  }
}
