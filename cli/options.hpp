#pragma once
/// Options that several verbs share, declared once so that they read and fail alike.

#include <CLI/App.hpp>
#include <memory>
#include <string>

#include "firn/registry.hpp"
#include "firn/scene.hpp"

namespace firn::cli {

struct SceneOption {
  std::string name;
  double scale = 1;

  /// Reads the file or built-in scene. Throws InputError.
  Scene read() const;
};

/// One thread per 16384 particles, at most one per processor: a step of fewer is
/// over before a second thread pays for its waking, and waiting threads are
/// harmful where processors are shared.
int threads_worth_having(std::size_t particles);

/// SCENE and --scale.
std::shared_ptr<SceneOption> add_scene_option(CLI::App& verb);

struct SolverOption {
  std::string name;
  std::string precision = "double";
  int threads = 0;         ///< 0: as many as the scene keeps busy
  double time_limit = 60;  ///< for each answer of a guest [s]

  /// For a scene of that many particles. Throws InputError.
  std::unique_ptr<Solver> create(const Registry& registry, std::size_t particles) const;
  SolverOptions settings(std::size_t particles) const;
};

/// --solver, --precision, --threads and --time-limit.
std::shared_ptr<SolverOption> add_solver_option(CLI::App& verb, const Registry& registry,
                                                const std::string& default_solver);

}  // namespace firn::cli
