// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A running error analysis of one time step.
///
/// ErrorBounds holds, for every particle and node, how far a correct solver of
/// the given precision may be from the reference at the present stage boundary.
/// It starts as the rounding of the loaded state; each stage takes the bounds of
/// its input, applies its own condition numbers (computed from the reference's
/// numbers at that particle or node) and adds its own roundoff (roundoff.hpp).
/// A subject that stops after every stage is loaded afresh each time, so only
/// one stage's growth counts; one that stops rarely gets the stages' product.
/// Nothing here is fitted: every term is the first-order propagation of an error
/// through the stage's equation.

#include <cstddef>
#include <vector>

#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "verification/check/cause.hpp"
#include "verification/check/contact_outcomes.hpp"
#include "verification/check/roundoff.hpp"
#include "verification/check/stencil.hpp"

namespace firn::check {

/// Bounds of the absolute error, in the unit of the field: of each component of
/// x (per axis), of the Euclidean norm of vectors, of the Frobenius norm of
/// matrices. `unbounded` where nothing can be said.
struct ErrorBounds {
  std::vector<Vec3> x;
  std::vector<double> v, V_0, F_E, F_P;
  std::vector<double> m_i, v_i, f, v_star, free_directions, v_new;

  /// Semi-implicit: ‖v* − B v‖ in the mass norm, tolerance and roundoff together.
  double implicit_residual = 0;

  /// Why a bound may be wide.
  std::vector<Cause> node_cause, particle_cause;

  /// Mass that rounded positions alone can move to or from a node in step 1 [kg].
  /// Kept for the whole step: a node lighter than this may be missing on one side.
  std::vector<double> uncertain_mass;
};

/// The model at work on one step: stages in order, from `rasterize`.
class BoundModel {
 public:
  BoundModel(const Scene& scene, Precision precision);

  const ErrorBounds& bounds() const { return bounds_; }
  const Stencils& stencils() const { return stencils_; }
  const Roundoff& roundoff() const { return r_; }

  /// The subject has just been loaded with `state`.
  void load(const State& state);

  /// `stage` led from `before` to `after` in the reference, with time step dt; `indefinite`:
  /// its implicit solve met negative curvature. After a contact stage the bounds are those of
  /// the first outcomes, the reference's own.
  void advance(Stage stage, const State& before, const State& after, double dt, bool indefinite);

  /// Nodes or particles for which the contact stage that ran last has more than one outcome.
  const std::vector<DoubtfulContact>& doubtful() const { return doubtful_; }

  /// Before the next stage: that the solver took this outcome. −1: any of them.
  void choose(const DoubtfulContact& contact, int outcome);

 private:
  void rasterize(const State& before, const State& after);
  void volumes(const State& before, const State& after);
  void grid_forces(const State& before, const State& after);
  void grid_velocities(const State& before, const State& after, double dt);
  void grid_collisions(const State& before, const State& after);
  void integration(const State& before, const State& after, double dt, bool indefinite);
  double stiffness_roundoff(const State& before, const Grid& grid) const;
  void deformation(const State& before, double dt);
  void particle_velocities(const State& after_integration);
  void particle_collisions(const State& before);
  void positions(const State& before, const State& after, double dt);

  const Scene& scene_;
  Roundoff r_;
  ErrorBounds bounds_;
  Stencils stencils_;
  std::vector<DoubtfulContact> doubtful_;
  Stage doubtful_stage_ = Stage::grid_collisions;
};

/// |x| as positions are rounded: the larger of its distances from zero and from
/// the grid's origin, and not less than four cells, the size of a block in which
/// a solver may keep block-local coordinates. Per axis [m].
Vec3 position_scale(const Scene& scene, const Vec3& x);

}  // namespace firn::check
