// SPDX-License-Identifier: BSD-3-Clause
#include "guests/command_solver.hpp"

#include <cstdlib>
#include <sstream>
#include <stdlib.h>
#include <unistd.h>

#include "firn/build_info.hpp"
#include "firn/error.hpp"
#include "firn/machine.hpp"
#include "guests/finite.hpp"
#include "guests/runner_process.hpp"
#include "guests/time_step.hpp"
#include "io/one_line.hpp"
#include "io/scene/scene_file.hpp"
#include "io/trajectory/writer.hpp"

namespace firn::guest {

namespace {

constexpr const char* input_name = "in.vtkhdf";
constexpr const char* output_name = "out.vtkhdf";

std::string replaced(std::string word, const std::string& from, const std::string& to) {
  for (std::size_t at = word.find(from); at != std::string::npos;
       at = word.find(from, at + to.size()))
    word.replace(at, from.size(), to);
  return word;
}

void require_placeholders(const std::string& command) {
  for (const char* placeholder : {"{in}", "{out}", "{steps}"})
    if (command.find(placeholder) == std::string::npos)
      throw InputError("--solver", std::string("placeholder ") + placeholder,
                       "none in exec:" + command, "exec:COMMAND with {in}, {out} and {steps}");
}

/// As execvp would find it.
bool is_program(const std::string& word) {
  if (word.find('/') != std::string::npos) return access(word.c_str(), X_OK) == 0;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "/bin:/usr/bin" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((std::filesystem::path(folder) / word).c_str(), X_OK) == 0) return true;
  return false;
}

std::filesystem::path make_folder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "firn-guest-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr)
    throw InputError("--solver", "temporary folder", pattern, "a writable folder (TMPDIR)");
  return pattern;
}

}  // namespace

std::vector<std::string> split_command(const std::string& command) {
  std::vector<std::string> words;
  bool in_word = false;
  char quote = 0;
  for (const char c : command) {
    if (quote != 0 && c == quote) {
      quote = 0;
    } else if (quote != 0) {
      words.back() += c;
    } else if (c == ' ' || c == '\t') {
      in_word = false;
    } else {
      if (!in_word) words.emplace_back();
      in_word = true;
      if (c == '\'' || c == '"')
        quote = c;
      else
        words.back() += c;
    }
  }
  if (quote != 0)
    throw InputError("--solver", "quote", command, "a closing quote for every opening one");
  if (words.empty())
    throw InputError("--solver", "command", "nothing", "exec:COMMAND with {in}, {out} and {steps}");
  return words;
}

CommandSolver::CommandSolver(const std::string& command, const SolverOptions& options)
    : words_(split_command(command)), time_limit_(options.time_limit) {
  require_placeholders(command);
  if (!is_program(words_.front()))
    throw InputError("--solver", "program to run", words_.front(),
                     "an executable file, with a path or on PATH");
  traits_.name = "exec:" + command;
  traits_.precision = options.precision;
  traits_.stops = {Stage::positions};
  traits_.pace = Pace::process;
  traits_.semi_implicit = true;  // the scene tells it; what it makes of it is judged
  folder_ = make_folder();
}

CommandSolver::~CommandSolver() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void CommandSolver::load(const Scene& scene, const State& state) {
  if (state.next != Stage::rasterize)
    throw InputError("--solver", "state inside a step", std::string(name(state.next)),
                     "between steps: a command takes whole steps");
  scene_ = &scene;
  state_ = state;
  state_.grid.clear();
}

TimeStep CommandSolver::choose_time_step() {
  return guest::choose_time_step(*scene_, state_.particles);
}

StepReport CommandSolver::advance_through(Stage last, double dt) {
  if (last != Stage::positions)
    throw InputError("--solver", "stop of a command", std::string(name(last)), "positions");
  return steps(1, dt);
}

StepReport CommandSolver::steps(std::int64_t count, double dt) {
  write_input(dt);
  run_command(count);
  read_output(count, dt);
  StepReport report;
  report.dt = dt;
  return report;
}

Diagnostics CommandSolver::diagnostics(const Scene& scene) const {
  if (const auto fault = not_finite(state_.particles)) fail(*fault);
  return measure(scene, state_);
}

void CommandSolver::write_input(double dt) const {
  Scene scene = *scene_;
  scene.time.adaptive = false;
  scene.time.step = dt;
  TrajectoryInfo info;
  info.solver = "firn";
  info.precision = traits_.precision;
  info.firn_version = build_info().version;
  info.processor = processor_name();
  info.scene = resolved_toml(scene);
  std::filesystem::remove(folder_ / input_name);
  std::filesystem::remove(folder_ / output_name);
  TrajectoryWriter writer(folder_ / input_name, info,
                          static_cast<std::int64_t>(state_.particles.size()), 0, 1, 0);
  writer.write_frame(state_, {});
  writer.finish();
}

void CommandSolver::run_command(std::int64_t steps) const {
  std::vector<std::string> words = words_;
  for (std::string& word : words) {
    word = replaced(word, "{in}", (folder_ / input_name).string());
    word = replaced(word, "{out}", (folder_ / output_name).string());
    word = replaced(word, "{steps}", std::to_string(steps));
  }
  ChildOptions options;
  // One state, with room for whatever else the guest keeps.
  options.most_bytes = (std::uint64_t{1} << 30) + 4096 * state_.particles.size();
  ChildProcess process(words, options);
  const double limit = time_limit_ * static_cast<double>(steps);
  if (!process.wait_until(deadline_after(limit)))
    fail("did not end within " + to_text(limit) + " s");
  if (process.exit_status() == unsupported_status)
    throw Unsupported("guest " + traits_.name + " does not support this: " +
                      (process.last_line().empty() ? "no reason given" : process.last_line()));
  if (!process.succeeded()) fail("ended: " + process.how_it_ended());
}

void CommandSolver::read_output(std::int64_t steps, double dt) {
  const std::filesystem::path path = folder_ / output_name;
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) fail("wrote no file at {out}");
  // Anything else, such as a pipe, could make its reader wait forever.
  if (!std::filesystem::is_regular_file(status))
    fail("wrote something at {out} that is not a file");
  State stored = read_trajectory(path);
  if (stored.particles.id != state_.particles.id)
    fail("returned the particles with other ids or in another order");
  // Material indices mean the scene's; time and step are Firn's own count.
  stored.particles.material = state_.particles.material;
  stored.time = state_.time;
  for (std::int64_t n = 0; n < steps; ++n) stored.time += dt;
  stored.step = state_.step + steps;
  state_ = std::move(stored);
}

State CommandSolver::read_trajectory(const std::filesystem::path& path) const {
  const double limit = time_limit_;
  const std::size_t particles = state_.particles.size();
  RunnerProcess reader({"--read", path.string(), std::to_string(particles)});
  try {
    Packet answer = reader.ask(Packet(Kind::store), limit, largest_packet(particles));
    if (answer.kind == Kind::failure)
      fail("wrote no trajectory: " +
           one_line(replaced(answer.get_text(), path.string(), "{out}"), 500));
    State state = get_state(answer);
    answer.expect_end();
    return state;
  } catch (const ChannelError& error) {
    fail("wrote a file that HDF5 cannot handle: its reader " + reader.what_happened(error, limit));
  }
}

void CommandSolver::fail(const std::string& what) const {
  SimulationError error(Stage::positions, SimulationError::Subject::solver, -1,
                        "guest " + traits_.name + " " + what);
  error.state_intact = true;
  throw error;
}

}  // namespace firn::guest
