// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The reference solver on a small scene, one stage at a time: what the interactive
/// page of a lesson runs in the browser, and what the tests run natively.

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firn/scene.hpp"
#include "firn/solver.hpp"

namespace firn::web {

enum class Preset {
  impact,     ///< the built-in scene tiny_impact
  collision,  ///< two snowballs in free space: nothing outside acts on them
};

/// What the page has a slider for.
enum class Parameter {
  youngs_modulus,
  poisson_ratio,
  density,  ///< from the next restart on
  hardening,
  critical_compression,
  critical_stretch,
  flip,
  implicitness,  ///< 0: explicit
  time_step,
  gravity,  ///< along −z
  friction,
  spacing,  ///< from the next restart on
  speed,    ///< of the fall, or of each ball; from the next restart on
};
inline constexpr int parameter_count = 13;

/// Mass, momentum and energy of the particles, and of the grid where it carries the motion.
struct Invariants {
  double mass = 0;
  Vec3 momentum = Vec3::Zero();
  double kinetic = 0, elastic = 0, gravitational = 0;
  double grid_mass = 0;
  Vec3 grid_momentum = Vec3::Zero();  ///< of the newest of v_i, v_i*, v_i^{n+1}
  double grid_kinetic = 0;
};

/// Of one particle, for colouring: J_E, J_P, smallest and largest singular value of F_E.
struct Strain {
  double J_E, J_P, smallest, largest;
};

class Session {
 public:
  explicit Session(Preset preset);

  /// Takes effect with the next step; density, spacing and speed with the next restart.
  void set(Parameter parameter, double value);
  double get(Parameter parameter) const;

  /// Back to t = 0 with the present parameters.
  void restart();

  /// One stage. False: it failed, error() tells why, and the step starts again from its
  /// beginning.
  bool advance();

  const State& state() const { return state_; }
  const Scene& scene() const { return scene_; }
  const std::string& error() const { return error_; }
  Invariants invariants() const;
  std::vector<Strain> strains() const;

  /// FNV-1a over every bit of time and particles: the same from every platform.
  std::uint64_t hash() const;

 private:
  void apply_parameters();

  Preset preset_;
  std::array<double, parameter_count> parameters_;
  Scene scene_;
  std::unique_ptr<Solver> solver_;
  State state_;
  std::string error_;
};

/// The scene of a preset with its own parameters.
Scene preset_scene(Preset preset);

}  // namespace firn::web
