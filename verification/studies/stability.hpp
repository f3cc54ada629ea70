// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The largest stable time step: by experiment, and as the linear theory predicts it.
///
/// The experiment perturbs F of an undeformed periodic block of 8×4×4 cells, or of one particle,
/// and calls a step stable if the perturbation has not grown 10⁴-fold after 600 steps. It
/// perturbs F, not v: a particle carries no velocity gradient.

#include <cstdint>
#include <vector>

#include "verification/studies/subject.hpp"

namespace firn::studies {

/// One point of the map of limits.
struct StabilityPoint {
  double alpha = 0.95, E = 1.4e5, h = 0.05, J_P = 1, jitter = 0, hardening = 10, beta = 0;
  int per_edge = 2;        ///< particles per cell edge: 1, 2, 3
  bool lone = false;       ///< one particle instead of the block
  bool estimated = false;  ///< volumes found by step 2
  double place = 0.25;     ///< of a lone particle in its cell, along each axis [h]
  std::uint64_t seed = 1;  ///< of the perturbation and the jitter

  bool semi_implicit() const { return beta > 0; }
  /// c from E, ν = 0.2, ρ = 400, hardened: c e^{ξ(1−J_P)/2} [m/s].
  double sound_speed() const;
  /// Δt of c Δt/h = 1 [s].
  double unit_step() const { return h / sound_speed(); }
};

constexpr int stability_steps = 600;

/// Size of the perturbation of F: far above its roundoff, far below what is not linear.
double perturbation(Precision precision);
/// A perturbation that has grown by this factor is unstable: 1.5 % per step in double.
double burst_growth(Precision precision);

/// Throws the solver's SimulationError where it fails on a perturbation that has not grown.
bool stable(const Subject& subject, const StabilityPoint& point, double cfl);

/// c Δt/h up to which a limit is looked for: far beyond what accuracy allows.
constexpr double largest_tried = 16;

struct StabilityLimit {
  double cfl = 0;                        ///< largest stable c Δt/h, to about half a per cent
  bool unlimited = false;                ///< stable even at `largest_tried`
  bool none = false;                     ///< unstable even at the smallest step tried
  std::vector<double> held, burst = {};  ///< what was tried, by outcome, in order
};

/// Bisection between 0.05 and 3 (`largest_tried` where steps are semi-implicit).
StabilityLimit largest_stable(const Subject& subject, const StabilityPoint& point);

/// A plane wave sampled evenly: one step maps the amplitudes of strain and velocity linearly, so
/// that any amplitude obeys a_{n+1} = tr a_n − det a_{n−1}. With N = sinc⁴(kh/2), z = ckΔtN,
/// b = βz²:
///     det = α(1−N²)(1 − z²/(1+b)) + N²/(1+b),  tr = α(1−N²) + N²/(1+b) + 1 − z²/(1+b).
struct WaveRecurrence {
  double det = 0, tr = 0;
};
WaveRecurrence wave_recurrence(double alpha, double beta, double kh, double cfl);

/// c Δt/h up to which a step multiplies any wave by `growth` at most; 1 gives the stability
/// limit. In bulk it is where the larger root of a² − tr a + det leaves the circle of that
/// radius, for the worst wave number: 1.572, 1.498, 1.496 at α = 0, 0.95, 1 with β = 0;
/// `largest_tried` if it never does. Holds for particles that sample every wave evenly.
double predicted_cfl(const StabilityPoint& point, double growth = 1);

}  // namespace firn::studies
