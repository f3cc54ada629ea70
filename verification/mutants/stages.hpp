// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The reference's step as a table of functions, and ways to patch one of them.

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "firn/solver.hpp"
#include "reference/steps.hpp"
#include "verification/mutants/mutants.hpp"

namespace firn::mutants {

/// What a stage works on.
struct Step {
  const Scene& scene;
  double time, dt;  ///< tⁿ, Δt [s]
  int threads;
  Particles& particles;
  reference::Stencils& stencils;
  Grid& grid;
  StepReport& report;
};

using StageFunction = std::function<void(const Step&)>;

struct Stages {
  /// Fills grid.node and whatever finds the nodes around a particle.
  StageFunction find_nodes;
  std::array<StageFunction, stage_count> run;
  std::function<TimeStep(const Scene&, const Particles&)> choose_time_step;
  /// The stages of step() where it goes another way than advance_through().
  std::shared_ptr<const Stages> whole_step;

  StageFunction& operator[](Stage stage) {
    return run[static_cast<std::size_t>(number(stage)) - 1];
  }
  const StageFunction& operator[](Stage stage) const {
    return run[static_cast<std::size_t>(number(stage)) - 1];
  }
};

/// The right ones.
Stages reference_stages();

using Patch = std::function<void(Stages&)>;

/// `change` decides when and on what the right stage runs.
Patch around(Stage stage, std::function<void(const StageFunction& right, const Step&)> change);

/// `spoil` runs after the right stage.
Patch after(Stage stage, StageFunction spoil);

/// The right stage in a scene that `change` has altered.
Patch in_other_scene(Stage stage, std::function<void(Scene&, const Step&)> change);

/// As above, `change` applied to every collider.
Patch with_other_colliders(Stage stage, std::function<void(Collider&)> change);

/// The right stage on a copy of the particles that `change` has altered: only what it
/// writes to the grid is wrong.
Patch from_other_particles(Stage stage, std::function<void(Particles&, const Step&)> change);

/// Adds mutants of one stage to a list, one call each.
class Adder {
 public:
  Adder(std::vector<Mutant>& list, Stage stage) : list_(list), stage_(stage) {}
  /// The mutant just added, for what is special about it.
  Mutant& operator()(const char* name, const char* mistake, const char* origin, Patch patch);

 private:
  std::vector<Mutant>& list_;
  Stage stage_;
};

/// Those of stages 1, 2 and 4, of 3, of 5 and 9, of 6, of 7, of 8 and 10, of the kernel, of the
/// program around the stages, and those that only a large scene or a long run shows.
void add_grid_mutants(std::vector<Mutant>& list);
void add_stress_mutants(std::vector<Mutant>& list);
void add_contact_mutants(std::vector<Mutant>& list);
void add_solve_mutants(std::vector<Mutant>& list);
void add_deformation_mutants(std::vector<Mutant>& list);
void add_particle_mutants(std::vector<Mutant>& list);
void add_kernel_mutants(std::vector<Mutant>& list);
void add_program_mutants(std::vector<Mutant>& list);
void add_distance_mutants(std::vector<Mutant>& list);
void add_scale_mutants(std::vector<Mutant>& list);

/// Step 1 with one grid per thread, added up at the end.
void rasterize_by_threads(const Step& s);

/// Material of particle p.
inline const Material& material_of(const Step& s, std::size_t p) {
  return s.scene.materials[static_cast<std::size_t>(s.particles.material[p])];
}

/// ∇v_p = Σ_i v_i (∇w_ip)ᵀ [1/s].
Mat3 velocity_gradient(const Step& s, std::size_t p, const std::vector<Vec3>& v);

/// Where people get their mistakes from.
inline constexpr const char* slip = "a slip of the pen";
inline constexpr const char* field = "seen in published codes of the field";

}  // namespace firn::mutants
