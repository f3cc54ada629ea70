// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// One time step of the reference solver, recorded after every stage: what
/// `firn teach` shows.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firn/diagnostics.hpp"
#include "firn/scene.hpp"
#include "firn/solver.hpp"
#include "reference/polar.hpp"
#include "reference/svd.hpp"

namespace firn::teach {

struct LessonOptions {
  std::optional<std::int64_t> step;      ///< the step shown, counted from 0; none: chosen
  std::optional<std::int64_t> particle;  ///< id; none: chosen
  std::optional<NodeIndex> node;         ///< none: chosen
};

/// What happened in a step beyond free motion.
struct StepEvents {
  std::int64_t nodes_in_contact = 0;      ///< v_i* changed by stage 5
  std::int64_t particles_yielding = 0;    ///< F_P changed by stage 7
  std::int64_t particles_in_contact = 0;  ///< v_p changed by stage 9

  /// How many of the three happened.
  int kinds() const {
    return (nodes_in_contact > 0) + (particles_yielding > 0) + (particles_in_contact > 0);
  }
};

/// The state before a step and after each of its stages.
struct StepRecord {
  std::array<State, stage_count + 1> after;  ///< [0]: before; [n]: after stage n
  StepReport report;
  TimeStep time_step;
  StepEvents events;

  const State& before(Stage stage) const {
    return after[static_cast<std::size_t>(number(stage)) - 1];
  }
  const State& behind(Stage stage) const { return after[static_cast<std::size_t>(number(stage))]; }
};

/// One of the 64 nodes around the chosen particle.
struct StencilNode {
  std::size_t node = 0;  ///< place in the grid of the record
  double w_ip = 0;
  Vec3 grad_w_ip = Vec3::Zero();  ///< [1/m]
};

/// The chosen particle's deformation in stage 7, factored by the reference's own SVD.
struct Decomposition {
  Mat3 grad_v_p;  ///< [1/s]
  Mat3 F_E_hat;
  reference::Svd usv;      ///< of F̂_E
  reference::Polar polar;  ///< of F̂_E
};

/// The same stretch of time from the same state, with a longer Δt, in both integrators.
struct ImplicitTrial {
  double multiple = 1;  ///< of the step's own Δt
  double dt = 0;        ///< [s]
  int steps = 0;
  StepReport first_step;                            ///< of the semi-implicit solver
  Diagnostics semi_implicit, explicit_euler;        ///< at the end
  std::string semi_implicit_error, explicit_error;  ///< what failed, if it did
};

struct Lesson {
  Scene scene;
  StepRecord record;
  StepRecord first;  ///< step 0: stage 2 acts there only
  Diagnostics before, after;
  std::size_t particle = 0;  ///< index
  std::size_t node = 0;      ///< place in the sorted grid
  std::string why_step, why_particle, why_node;
  std::vector<StencilNode> stencil;  ///< of the chosen particle
  Decomposition decomposition;
  std::vector<ImplicitTrial> implicit_trials;
};

/// Runs the scene up to the step to be shown and records it. Throws InputError
/// for a step, particle or node that is not there, SimulationError if the
/// reference cannot reach the step that was asked for.
Lesson make_lesson(const Scene& scene, const LessonOptions& options = {});

}  // namespace firn::teach
