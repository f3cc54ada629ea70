// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Hard cases of a few particles and a few steps that are known to break codes. A solver may go on
/// or stop with an error that says where. It must never return a NaN or an infinity without an
/// error.

#include <string>
#include <vector>

#include "firn/error.hpp"
#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "verification/studies/subject.hpp"

namespace firn::studies {

enum class Expected { goes_on, stops, either };

struct Situation {
  std::string name;
  Expected expected = Expected::goes_on;
  Scene scene = {};
  State state = {};
  double dt = 0;  ///< [s]
  int steps = 1;
  std::int64_t culprit = -1;  ///< index of the particle that an error may name; −1: none
};

struct StressOutcome {
  enum class Ending {
    went_on,
    failed,   ///< SimulationError
    refused,  ///< InputError
    silent,   ///< numbers that are not finite, and no error
  };
  Ending ending = Ending::went_on;
  int steps = 0;             ///< that went through
  std::string message = {};  ///< of the error
  Stage stage = Stage::rasterize;
  std::int64_t particle = -1;  ///< that the error names, or −1
  bool unsupported = false;    ///< refused by a solver that does not do this
  bool intact = false;         ///< a SimulationError that left the last good state
  State state = {};            ///< at the end, or the last good one if it is intact
  double fastest = 0;          ///< largest ‖v_p‖ after any step [m/s]

  bool stopped() const { return ending == Ending::failed || ending == Ending::refused; }
  std::string text() const;  ///< what the solver did
};

/// Takes the steps and looks at every number after each.
StressOutcome run(const Subject& subject, const Situation& situation);

bool finite(const Particles& particles);
Vec3 momentum(const Particles& particles);

/// h = 0.05, Δt = 1e-4, 20 steps: lone particles and a cell of 2×2×2. The map of `firn bench`.
std::vector<Situation> cell_situations();

// h = 1/16, α = 0.95: rows of particles a quarter of a cell apart, with positions and velocities
// that float holds exactly. The questions of `firn verify`.
inline constexpr double row_spacing = 0x1p-4;
Scene row_scene();
/// n particles at rest.
State row_of_particles(std::size_t n);
std::vector<Situation> few_in_a_row(int steps);
Situation empty_row();
std::vector<Situation> awkward_places(int steps);
std::vector<Situation> far_in_one_step(int steps);
std::vector<Situation> no_deformations();
Situation hardening_overflow(Precision precision);
std::vector<Situation> outside_the_domain(Precision precision);
std::vector<Situation> not_a_number();

}  // namespace firn::studies
