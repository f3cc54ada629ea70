// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The one interface behind which every solver stands: the reference, the
/// optimized one, the mutants, and anybody's own.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firn/diagnostics.hpp"
#include "firn/scene.hpp"
#include "firn/stage.hpp"
#include "firn/state.hpp"
#include "firn/time_step.hpp"

namespace firn {

/// What a whole step did.
struct StepReport {
  double dt = 0;                       ///< [s]
  std::int64_t grid_nodes = 0;         ///< nodes of positive mass
  std::int64_t solver_iterations = 0;  ///< semi-implicit solve
  /// True relative residual ‖v* − B v‖/‖v*‖ along the free directions, B v =
  /// v + βΔt² M⁻¹H v, recomputed at the end; ‖r‖² = Σ m_i |r_i|².
  double solver_residual = 0;
  bool solver_indefinite = false;  ///< negative curvature was met
};

/// How long a step takes, roughly: benchmarks and suites choose their scenes by it.
enum class Pace {
  fast,    ///< as the hardware allows
  plain,   ///< a microsecond and more per particle, by design
  process  ///< every step starts a program
};

/// What a solver is and can do. load() throws InputError for anything beyond it.
struct SolverTraits {
  std::string name;  ///< as the registry knows it
  Precision precision = Precision::float64;
  std::vector<Stage> stops;    ///< stages after which advance_through() can stop, in order; always
                               ///< ends with `positions`
  bool semi_implicit = false;  ///< supports semi-implicit scenes
  bool explicit_euler = true;  ///< supports explicit scenes
  Pace pace = Pace::fast;
};

/// One simulation in one solver's own data layout.
///
/// load() a state, then call step() or advance_through() as often as you like, and
/// store() whenever you want to look. A solver is a function: the state
/// it reaches depends on what it was loaded with and on Δt, never on the number
/// of threads or on what it did before.
class Solver {
 public:
  virtual ~Solver() = default;
  Solver() = default;
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  virtual const SolverTraits& traits() const = 0;

  /// Takes over a scene, which outlives the simulation, and a state, which may stand between any
  /// two stages at which this solver stops (State::next), so that `check` can hand over the
  /// reference's own input of every stage. Throws InputError if the scene asks
  /// for what the solver does not support.
  virtual void load(const Scene& scene, const State& state) = 0;

  /// Δt by the scene's rule (firn/time_step.hpp) for the present state.
  virtual TimeStep choose_time_step() = 0;

  /// Runs every stage from the present one up to and including `last`, one of
  /// traits().stops, with time step dt (the same value until the step is
  /// complete). Throws SimulationError.
  virtual StepReport advance_through(Stage last, double dt) = 0;

  /// A whole step by the solver's fastest path; bit for bit what
  /// advance_through() reaches in ten stages. Throws SimulationError.
  virtual StepReport step(double dt) { return advance_through(Stage::positions, dt); }

  /// `count` ≥ 1 whole steps of the same dt. One after the other, unless a solver pays for each
  /// call: a command takes them all in one process. Reports the last. Throws SimulationError.
  virtual StepReport steps(std::int64_t count, double dt) {
    StepReport report;
    for (std::int64_t n = 0; n < count; ++n) report = step(dt);
    return report;
  }

  /// Writes the present state: particles in the order of load(), nodes of
  /// positive mass sorted by (i,j,k). Between steps the grid may be left empty.
  virtual void store(State& state) const = 0;

  /// Diagnostics of the present state, between steps; `scene` is the one that was
  /// loaded. The default stores the state and measures it. `grid_nodes`, `dt` and
  /// `solver_iterations` are filled by the caller from the StepReport.
  virtual Diagnostics diagnostics(const Scene& scene) const;

  /// What a restart needs beyond State to repeat every bit: a particle order,
  /// digits that double does not hold. Fixed in size between load() and the
  /// next load(); 0 for solvers whose State says it all.
  virtual std::size_t restart_size() const { return 0; }
  virtual void store_restart(std::span<std::byte> /*bytes*/) const {}
  /// Called right after load() with what store_restart() wrote at that state.
  virtual void load_restart(std::span<const std::byte> /*bytes*/) {}

  /// Bytes of memory that the solver holds per particle, all in all; 0 = not counted.
  virtual double bytes_per_particle() const { return 0; }
};

}  // namespace firn
