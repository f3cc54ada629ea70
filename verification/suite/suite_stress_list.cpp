// SPDX-License-Identifier: BSD-3-Clause
/// What breaks other codes: each ends in a defined result or in an error that says where.

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>

#include "firn/error.hpp"
#include "verification/studies/float_drift.hpp"
#include "verification/studies/stress_list.hpp"
#include "verification/suite/probes.hpp"

namespace firn::suite {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using studies::Expected;
using studies::Situation;
using studies::StressOutcome;

void goes_well(const Situation& situation, const StressOutcome& o) {
  if (o.unsupported) throw Unsupported(o.message);
  const bool went_on = o.ending == StressOutcome::Ending::went_on;
  expect(situation.name, went_on, o.text());
  if (!went_on) return;
  const Totals before = totals(situation.state.particles), after = totals(o.state.particles);
  within("momentum", (after.momentum - before.momentum).norm(),
         450 * eps() * (before.momentum_scale + after.momentum_scale));
}

/// An error that names the stage and, where it names a particle, the right one.
void fails(const Situation& situation, const StressOutcome& o) {
  const std::string& what = situation.name;
  expect(what + ": an error", o.stopped(), "the step went through");
  if (o.ending != StressOutcome::Ending::failed) return;
  expect(what + ": names the particle, if one", o.particle < 0 || o.particle == situation.culprit,
         fmt::format("particle {} named for {}: {}", o.particle, situation.culprit, o.message));
  if (!o.intact) return;
  const Particles &now = o.state.particles, &initial = situation.state.particles;
  bool same = now.size() == initial.size();
  for (std::size_t q = 0; same && q < initial.size(); ++q)
    if (static_cast<std::int64_t>(q) != situation.culprit)
      same = now.v[q] == initial.v[q] && now.x[q] == initial.x[q];
  expect(what + ": the last good state is kept", same);
}

void judge(const Situation& situation) {
  const StressOutcome o = studies::run(study_subject(), situation);
  switch (situation.expected) {
    case Expected::goes_on: return goes_well(situation, o);
    case Expected::stops: return fails(situation, o);
    // Either finite numbers, or an error; never numbers that are none.
    case Expected::either:
      expect(situation.name, o.ending != StressOutcome::Ending::silent, o.text());
  }
}

void judge(const std::vector<Situation>& situations) {
  for (const Situation& situation : situations) judge(situation);
}

FIRN_TEST(StressList, few_particles) {
  judge(studies::few_in_a_row(effort(20, 2)));
  const Situation empty = studies::empty_row();
  const StressOutcome none = studies::run(study_subject(), empty);
  expect(empty.name,
         none.ending == StressOutcome::Ending::refused ||
             (none.ending == StressOutcome::Ending::went_on && none.state.particles.size() == 0),
         none.message);
}

FIRN_TEST(StressList, awkward_places) { judge(studies::awkward_places(effort(20, 2))); }

FIRN_TEST(StressList, far_in_one_step) { judge(studies::far_in_one_step(effort(10, 2))); }

FIRN_TEST(StressList, matrices_that_are_no_deformations) { judge(studies::no_deformations()); }

FIRN_TEST(StressList, hardening_overflow) {
  judge(studies::hardening_overflow(subject().precision));
}

FIRN_TEST(StressList, leaving_the_domain) {
  judge(studies::outside_the_domain(subject().precision));
}

FIRN_TEST(StressList, not_a_number_in_the_state) { judge(studies::not_a_number()); }

/// NaN in what one stage left for the next must not come out as a number or go unnoticed.
FIRN_TEST(StressList, not_a_number_between_stages) {
  const double dt = 0x1p-13;
  const Scene scene = studies::row_scene();
  State initial = studies::row_of_particles(6);
  for (Mat3& F : initial.particles.F_E) F *= 0.995;
  const auto spoil = [&](Stage stage, Stage writer, const char* what, auto change) {
    const Stage before = static_cast<Stage>(number(stage) - 1);
    if (!stops_at(before)) return;
    State state = before_stage(scene, initial, stage, dt);
    change(state.grid);
    bool told = false;
    std::string message;
    const auto solver = make_subject();
    try {
      solver->load(scene, state);
      solver->advance_through(Stage::positions, dt);
    } catch (const SimulationError& error) {
      // A stage that meets it, or the one whose work it is.
      told = error.stage() >= stage || error.stage() == writer;
      message = error.what();
    } catch (const InputError&) {
      told = true;
    }
    expect(fmt::format("NaN in {} before stage {}", what, number(stage)), told,
           message.empty() ? "the step went through" : message);
  };
  spoil(Stage::grid_velocities, Stage::rasterize, "v_i",
        [](Grid& g) { g.v[g.size() / 2][0] = nan; });
  spoil(Stage::grid_velocities, Stage::grid_forces, "f_i",
        [](Grid& g) { g.f[g.size() / 2][1] = nan; });
  spoil(Stage::grid_collisions, Stage::grid_velocities, "v_i*",
        [](Grid& g) { g.v_star[g.size() / 2][2] = nan; });
  spoil(Stage::integration, Stage::grid_collisions, "v_i*",
        [](Grid& g) { g.v_star[g.size() / 2][2] = nan; });
  spoil(Stage::deformation, Stage::integration, "v_i^{n+1}",
        [](Grid& g) { g.v_new[g.size() / 2][2] = nan; });
  spoil(Stage::particle_velocities, Stage::integration, "v_i^{n+1}",
        [](Grid& g) { g.v_new[g.size() / 2][2] = nan; });
}

/// x = 1 m, v = 1e-3 m/s, Δt = 1e-5 s: in float x + Δt v is x. Cell-relative positions move.
FIRN_TEST(StressList, small_steps_add_up) {
  const int steps = effort(2000, 5);
  Scene scene = studies::row_scene();
  scene.time.step = 1e-5;
  State state = studies::row_of_particles(1);
  state.particles.x[0] = Vec3(1, 1, 1);
  const double moved = steps * scene.time.step * 1e-3;
  const Vec3 off =
      studies::creep(study_subject(), scene, state, Vec3::Constant(rounded(1e-3)), steps, moved);
  // One step is 1.3 spacings of float numbers of the size of a cell: rounding to nearest has it
  // right to half of one.
  within("x = 1, v = 1e-3, Δt = 1e-5 moves", off.norm(), in_float() ? 0.5 : 1e-6);

  // A strain rate of 1e-3/s for 2000 steps of 1e-5 s: 1 + 1e-8 is 1 in float.
  scene.materials[0] = elastic_material();
  scene.materials[0].youngs_modulus = 1e-9;
  scene.flip = 1;
  studies::Stretch stretch;
  stretch.cells = 4;
  stretch.corner = Vec3::Constant(-2 * spacing);
  stretch.half_width = 0.25 * spacing;
  stretch.steps = steps;
  // The grid's field is linear but for the free surface, two cells away.
  within("a strain rate of 1e-3 1/s shows", studies::small_strain(study_subject(), scene, stretch),
         0.2);
}

}  // namespace
}  // namespace firn::suite
