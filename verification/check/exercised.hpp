// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What the compared states contained, counted stage by stage: a comparison says nothing about
/// what never occurred in it.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "firn/scene.hpp"
#include "firn/solver.hpp"
#include "firn/state.hpp"

namespace firn {

/// One thing that may occur in a step, counted in the reference's states.
enum class Feature {
  on_node,                ///< particles whose position is a node's
  on_face,                ///< particles on a face of a cell
  across_seam,            ///< particles whose nodes lie on both sides of a periodic seam
  light_node,             ///< nodes below 1e-6 of the heaviest particle's mass
  several_materials,      ///< nodes in reach of particles of several materials
  volume_estimated,       ///< particles
  compressed,             ///< particles with J_P < 1, hardened
  expanded,               ///< particles with J_P > 1, softened
  inverted,               ///< particles with det F_E ≤ 0
  degenerate,             ///< particles whose smallest |σ| of F_E is below 1e-3 of the largest
  node_separates,         ///< nodes inside a collider that move away from it: left alone
  node_sticks,            ///< nodes that take the collider's velocity
  node_slides,            ///< nodes that slide along a collider
  node_several,           ///< nodes inside several colliders
  friction,               ///< nodes and particles that slide, μ > 0
  no_friction,            ///< nodes and particles that slide, μ = 0
  sticky,                 ///< nodes and particles inside a sticky collider
  moving,                 ///< nodes and particles inside a collider that moves
  turning,                ///< nodes and particles inside a collider that turns
  solve,                  ///< semi-implicit solves that took iterations
  indefinite,             ///< solves that met negative curvature
  yields_in_compression,  ///< particles clamped at 1 − θ_c only
  yields_in_stretch,      ///< particles clamped at 1 + θ_s only
  yields_in_both,         ///< particles clamped at both
  elastic,                ///< particles that do not yield
  particle_separates,     ///< particles inside a collider, as for nodes
  particle_sticks,
  particle_slides,
  crosses_seam,         ///< particles that cross a periodic seam
  fixed_step,           ///< steps of the scene's fixed Δt
  step_by_max,          ///< steps whose Δt max_step decided …
  step_by_cfl,          ///< … or the CFL condition …
  step_by_elastic_cfl,  ///< … or the speed of sound
};
inline constexpr int feature_count = static_cast<int>(Feature::step_by_elastic_cfl) + 1;

/// How a feature is named in tables, in JSON and by `--require`.
struct FeatureName {
  Feature feature;
  const char* key;     ///< "node_slides"
  const char* phrase;  ///< "slide along a collider"
  const char* of;      ///< "particles", "nodes", "steps", …
  Stage stage;
};
const std::array<FeatureName, feature_count>& feature_names();

/// Counts over all compared steps.
class Exercised {
 public:
  std::int64_t operator[](Feature feature) const {
    return count_[static_cast<std::size_t>(feature)];
  }
  std::int64_t steps() const { return steps_; }
  std::int64_t iterations() const { return iterations_; }  ///< of all solves

  /// Counts what `stage` met on its way from `before` to `after`.
  void add(const Scene& scene, Stage stage, const State& before, const State& after,
           const StepReport& report);
  void add_step(TimeStepBound bound);
  void add(const Exercised& other);

 private:
  void add(Feature feature, std::int64_t n = 1) { count_[static_cast<std::size_t>(feature)] += n; }
  void places(const Scene& scene, const State& before, const State& after);
  void strains(const State& before);
  void node_contact(const Scene& scene, const State& before);
  void particle_contact(const Scene& scene, const State& before);
  /// Returns the number of colliders that hold x. `kinds`: separates, sticks, slides.
  int contact(const Scene& scene, const Vec3& x, Vec3 v, double time,
              const std::array<Feature, 3>& kinds);
  void yielding(const Scene& scene, const State& before, const State& after);

  std::array<std::int64_t, feature_count> count_{};
  std::int64_t steps_ = 0, iterations_ = 0;
};

/// What a user asks for: a feature of a scene that one or several counts show.
struct Requirement {
  const char* key;     ///< "plastic"
  const char* phrase;  ///< "plastic flow"
  std::vector<Feature> any_of;
};

/// Every word that `--require` takes: the groups, then the single features.
const std::vector<Requirement>& requirements();

/// True if one of its features occurred.
bool met(const Requirement& requirement, const Exercised& exercised);

/// What the scene can do and the compared states did not, as keys of requirements(): a group
/// where nothing of it occurred, else its missing members.
std::vector<std::string> not_exercised(const Scene& scene, const Exercised& exercised);

/// The phrase of a key: "plastic flow". Throws InputError for an unknown one.
const Requirement& requirement_of(const std::string& key);

}  // namespace firn
