// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Options that several verbs share, declared once so that they behave the same everywhere.

#include <CLI/App.hpp>
#include <memory>
#include <string>
#include <vector>

#include "firn/memory.hpp"
#include "firn/registry.hpp"
#include "firn/scene.hpp"

namespace firn::cli {

struct SceneOption {
  std::string name;
  double scale = 1;

  /// Reads the file or built-in scene. Throws InputError, also if `bytes_per_particle`, what the
  /// verb will need, is more than the memory that is available.
  Scene read(double bytes_per_particle = check_bytes_per_particle()) const;
};

/// One thread per 16384 particles, at most one per processor: with fewer particles a step
/// ends before waking a second thread pays, and waiting threads do harm on a shared machine.
int threads_worth_having(std::size_t particles);

/// SCENE and --scale.
std::shared_ptr<SceneOption> add_scene_option(CLI::App& verb);

/// A word of a command as a shell takes it, in quotes where it needs them.
std::string shell_word(const std::string& word);

struct SolverOption {
  std::string name;
  std::string precision = "double";
  int threads = 0;         ///< 0: threads_worth_having()
  double time_limit = 60;  ///< for each answer of a guest [s]

  /// The solver for a scene with this many particles. Throws InputError.
  std::unique_ptr<Solver> create(const Registry& registry, std::size_t particles) const;
  SolverOptions settings(std::size_t particles) const;

  /// What a run with this solver needs (firn/memory.hpp). Throws InputError.
  double run_bytes_per_particle(const Registry& registry) const;
};

/// --force, for verbs that write a file.
void add_force_option(CLI::App& verb, bool& force);

/// The files that a solver's name mentions: its library, what its command consists of.
std::vector<std::string> files_of_solver(const std::string& name);

/// --solver, --precision, --threads and --time-limit.
std::shared_ptr<SolverOption> add_solver_option(CLI::App& verb, const Registry& registry,
                                                const std::string& default_solver);

}  // namespace firn::cli
