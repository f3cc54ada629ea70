// SPDX-License-Identifier: BSD-3-Clause
#include "cli/options.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "firn/error.hpp"
#include "firn/machine.hpp"
#include "io/scene/scene_file.hpp"

namespace firn::cli {

Scene SceneOption::read(double bytes_per_particle) const {
  SceneOptions options;
  options.bytes_per_particle = bytes_per_particle;
  options.scale = scale;
  return find_scene(name, options);
}

std::shared_ptr<SceneOption> add_scene_option(CLI::App& verb) {
  auto option = std::make_shared<SceneOption>();
  verb.add_option("SCENE", option->name, "a scene file, or a name that `firn scenes` prints")
      ->required();
  verb.add_option("--scale", option->scale,
                  "refine by S: spacing h/S, time step Δt/S, S³ times as many particles")
      ->capture_default_str();
  return option;
}

std::string shell_word(const std::string& word) {
  constexpr const char* plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,+@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) {
    if (c == '\'')
      quoted.append("'\\''");
    else
      quoted.push_back(c);
  }
  return quoted + "'";
}

int threads_worth_having(std::size_t particles) {
  const std::size_t worth = 1 + particles / 16384;
  return static_cast<int>(std::min(worth, static_cast<std::size_t>(available_processors())));
}

SolverOptions SolverOption::settings(std::size_t particles) const {
  SolverOptions options;
  if (precision == "double") {
    options.precision = Precision::float64;
  } else if (precision == "float") {
    options.precision = Precision::float32;
  } else {
    throw InputError("--precision", "unknown precision", precision, "double or float");
  }
  if (threads < 0 || threads > 1024)
    throw InputError("--threads", "number of threads", std::to_string(threads),
                     "1 to 1024, or 0 for automatic");
  options.threads = threads == 0 ? threads_worth_having(particles) : threads;
  options.time_limit = time_limit;
  return options;
}

std::unique_ptr<Solver> SolverOption::create(const Registry& registry,
                                             std::size_t particles) const {
  return registry.create(name, settings(particles));
}

double SolverOption::run_bytes_per_particle(const Registry& registry) const {
  const bool is_guest = registry.find(name) == nullptr;  // not to be started only for this
  return firn::run_bytes_per_particle(is_guest ? Pace::process : registry.traits(name).pace,
                                      settings(1).precision);
}

void add_force_option(CLI::App& verb, bool& force) {
  verb.add_flag("--force", force, "replace an existing output even if Firn did not write it");
}

std::vector<std::string> files_of_solver(const std::string& name) {
  const std::string command = "exec:";
  std::istringstream words(name.rfind(command, 0) == 0 ? name.substr(command.size()) : name);
  std::vector<std::string> files;
  std::error_code error;
  for (std::string word; words >> word;)
    if (std::filesystem::is_regular_file(word, error)) files.push_back(word);
  if (std::filesystem::is_regular_file(name, error)) files.push_back(name);  // one with blanks
  return files;
}

namespace {

std::string help_of_solver(const Registry& registry) {
  std::string text = "a name that `firn solvers` prints";
  for (const SolverFamily& family : registry.families())
    text += "; " + family.form + ", " + family.description;
  return text;
}

}  // namespace

std::shared_ptr<SolverOption> add_solver_option(CLI::App& verb, const Registry& registry,
                                                const std::string& default_solver) {
  auto option = std::make_shared<SolverOption>();
  option->name = default_solver;
  verb.add_option("--solver", option->name, help_of_solver(registry))->capture_default_str();
  verb.add_option("--precision", option->precision, "double or float")->capture_default_str();
  verb.add_option("--threads", option->threads,
                  "number of threads; 0: one per 16384 particles, at most one per processor; the "
                  "result does not depend on it")
      ->capture_default_str();
  verb.add_option("--time-limit", option->time_limit,
                  "seconds that a library or command may take for one answer")
      ->capture_default_str();
  return option;
}

}  // namespace firn::cli
