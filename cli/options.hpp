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

/// SCENE and --scale.
std::shared_ptr<SceneOption> add_scene_option(CLI::App& verb);

struct SolverOption {
  std::string name;
  std::string precision = "double";
  int threads = 0;         ///< 0: as many as the machine has
  double time_limit = 60;  ///< for each answer of a guest [s]

  /// Throws InputError.
  std::unique_ptr<Solver> create(const Registry& registry) const;
  SolverOptions settings() const;
};

/// --solver, --precision, --threads and --time-limit.
std::shared_ptr<SolverOption> add_solver_option(CLI::App& verb, const std::string& default_solver);

}  // namespace firn::cli
