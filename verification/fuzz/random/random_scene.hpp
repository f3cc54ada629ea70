// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Scenes drawn from everything that a scene file can say.

#include <cstdint>

#include "firn/scene.hpp"

namespace firn {

/// A scene to compare two solvers on, and where in it.
struct RandomCase {
  Scene scene;                  ///< as its own TOML text gives it
  std::int64_t start_step = 0;  ///< steps that the reference runs alone first
  std::int64_t steps = 1;       ///< steps to compare
};

struct RandomOptions {
  std::int64_t max_particles = 600;
  bool semi_implicit = true;  ///< also semi-implicit scenes
  std::string mesh_file{};  ///< closed mesh in about [0,1]³ for bodies and colliders; empty: none
};

/// The same on every machine. One to three bodies of any shape, sampling and material, up
/// to four colliders of any motion, open or periodic axes, fixed or adaptive steps. Values
/// are such that snow stays near its colliders and steps are mostly stable; some are
/// chosen to be awkward (a plane through nodes, α = 0 or 1, no friction, no gravity).
RandomCase random_case(std::uint64_t seed, const RandomOptions& options = {});

/// The scene as a user would have it: written to TOML and read again. Throws InputError.
Scene through_toml(const Scene& scene, std::int64_t max_particles);

}  // namespace firn
