/// What breaks other codes: each ends in a defined result or in an error that says where.

#include <Eigen/LU>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>

#include "firn/error.hpp"
#include "verification/suite/probes.hpp"

namespace firn::suite {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Scene snow_scene() {
  Scene scene = plain_scene();
  scene.flip = 0.95;
  scene.materials = {Material{}};
  scene.materials[0].name = "snow";
  return scene;
}

/// n particles at rest, a quarter of a cell apart.
State row_of_particles(std::size_t n) {
  State state;
  Particles& p = state.particles;
  p.resize(n);
  for (std::size_t q = 0; q < n; ++q) {
    p.x[q] = spacing * Vec3(0.25 * static_cast<double>(q) + 0.125, 0.5, -0.75);
    p.m[q] = 0x1p-6;
    p.V_0[q] = 0x1p-15;
    p.id[q] = static_cast<std::int64_t>(q);
  }
  return state;
}

bool finite(const State& state) {
  const Particles& p = state.particles;
  for (std::size_t q = 0; q < p.size(); ++q)
    if (!p.x[q].allFinite() || !p.v[q].allFinite() || !p.F_E[q].allFinite() ||
        !p.F_P[q].allFinite())
      return false;
  return true;
}

/// How a run ended.
struct Outcome {
  bool failed = false, refused = false, intact = false;
  Stage stage = Stage::rasterize;
  std::int64_t index = -2;
  std::string message;
  State state;
};

Outcome run_to_the_end(const Scene& scene, const State& initial, int steps, double dt) {
  Outcome outcome;
  const auto solver = make_subject();
  try {
    solver->load(scene, initial);
    for (int n = 0; n < steps; ++n) solver->step(dt);
    solver->store(outcome.state);
  } catch (const SimulationError& error) {
    outcome.failed = true;
    outcome.stage = error.stage();
    outcome.index = error.subject() == SimulationError::Subject::particle ? error.index() : -1;
    outcome.message = error.what();
    outcome.intact = error.state_intact;
    if (error.state_intact) solver->store(outcome.state);
  } catch (const InputError& error) {
    outcome.refused = true;
    outcome.message = error.what();
  }
  return outcome;
}

void goes_well(const std::string& what, const Scene& scene, const State& initial, int steps,
               double dt) {
  const Outcome o = run_to_the_end(scene, initial, steps, dt);
  expect(what, !o.failed && !o.refused && finite(o.state), o.message);
  if (o.failed || o.refused) return;
  const Totals before = totals(initial.particles), after = totals(o.state.particles);
  within("momentum", (after.momentum - before.momentum).norm(),
         450 * eps() * (before.momentum_scale + after.momentum_scale));
}

/// Either finite numbers, or an error; never numbers that are none.
void ends_somehow(const std::string& what, const Scene& scene, const State& initial, int steps,
                  double dt) {
  const Outcome o = run_to_the_end(scene, initial, steps, dt);
  expect(what, o.failed || o.refused || finite(o.state),
         "numbers that are not finite, and no error");
}

/// An error that names the stage and, where it names a particle, the right one.
void fails(const std::string& what, const Scene& scene, const State& initial, double dt,
           std::int64_t particle) {
  const Outcome o = run_to_the_end(scene, initial, 1, dt);
  expect(what + ": an error", o.failed || o.refused, "the step went through");
  if (!o.failed) return;
  expect(what + ": names the particle, if one", o.index < 0 || o.index == particle,
         fmt::format("particle {} named for {}: {}", o.index, particle, o.message));
  if (!o.intact) return;
  bool same = o.state.particles.size() == initial.particles.size();
  for (std::size_t q = 0; same && q < initial.particles.size(); ++q)
    if (static_cast<std::int64_t>(q) != particle)
      same = o.state.particles.v[q] == initial.particles.v[q] &&
             o.state.particles.x[q] == initial.particles.x[q];
  expect(what + ": the last good state is kept", same);
}

TEST(StressList, few_particles) {
  const Scene scene = snow_scene();
  const int steps = effort(20, 2);
  for (const std::size_t n : {1u, 2u, 3u}) {
    State state = row_of_particles(n);
    for (Vec3& v : state.particles.v) v = Vec3(1, -2, 0.5);
    goes_well(fmt::format("{} particles", n), scene, state, steps, 0x1p-13);
  }
  const Outcome none = run_to_the_end(scene, State{}, 1, 0x1p-13);
  expect("no particle at all", !none.failed && (none.refused || none.state.particles.size() == 0),
         none.message);
}

TEST(StressList, awkward_places) {
  const Scene scene = snow_scene();
  const int steps = effort(20, 2);
  State coincident = row_of_particles(8);
  for (Vec3& x : coincident.particles.x) x = coincident.particles.x[0];
  for (Mat3& F : coincident.particles.F_E) F *= 0.99;
  for (Vec3& v : coincident.particles.v) v = Vec3(1, -1, 1);
  goes_well("coincident particles", scene, coincident, steps, 0x1p-13);
  State node = row_of_particles(4);
  for (Vec3& v : node.particles.v) v = Vec3(1, 0, -1);
  node.particles.x[0] = spacing * Vec3(2, -3, 0);
  node.particles.x[1] = spacing * Vec3(2, -3, std::nextafter(0.0, -1.0));
  goes_well("on a node, and beside it by the smallest number", scene, node, steps, 0x1p-13);
  Scene periodic = scene;
  periodic.grid.periodic = spacing * Vec3(4, 4, 4);
  State seam = row_of_particles(4);
  for (Vec3& x : seam.particles.x) x = periodic.wrap(x);
  seam.particles.x[0].setZero();
  seam.particles.x[1] = spacing * Vec3(4 - 0x1p-20, 4 - 0x1p-20, 0);
  for (Vec3& v : seam.particles.v) v = Vec3(3, 3, -3);
  goes_well("on the seam of a periodic domain of 4 cells", periodic, seam, steps, 0x1p-9);
}

TEST(StressList, far_in_one_step) {
  Scene scene = snow_scene();
  State fast = row_of_particles(6);
  for (std::size_t q = 0; q < 6; ++q) fast.particles.v[q] = Vec3(q % 2 == 0 ? 50 : -50, 20, 0);
  goes_well("v_p Δt > h", scene, fast, effort(10, 2), 0x1p-9);

  // v = −x/Δt: the cloud collapses into a point, F̂ = 0.
  State collapse;
  for (int i = 0; i < 64; ++i) {
    State one = row_of_particles(1);
    one.particles.x[0] = spacing * (Vec3(i / 16, i / 4 % 4, i % 4) / 2 - Vec3::Constant(0.75));
    one.particles.v[0] = -one.particles.x[0] / 0x1p-10;
    one.particles.id[0] = i;
    collapse.particles.append(one.particles);
  }
  ends_somehow("Δt ∇v = −I", scene, collapse, 3, 0x1p-10);
}

TEST(StressList, matrices_that_are_no_deformations) {
  const Scene scene = snow_scene();
  const struct {
    const char* name;
    Mat3 F;
  } list[] = {{"det F_E < 0", Vec3(1, 1, -0.99).asDiagonal()},
              {"−I", -Mat3::Identity()},
              {"rank 2", Vec3(1, 0.7, 0).asDiagonal()},
              {"rank 1", Vec3(1, 0, 0).asDiagonal()},
              {"zero", Mat3::Zero()},
              {"σ2 = −σ3", Vec3(1.5, 0.5, -0.5).asDiagonal()},
              {"1e-30", 1e-30 * Mat3::Identity()}};
  for (const auto& one : list) {
    State state = row_of_particles(6);
    state.particles.F_E[2] = one.F;
    ends_somehow(one.name, scene, state, 3, 0x1p-16);
  }
}

/// e^{ξ(1−J_P)} is beyond the largest number: J_P < −69.9 in double, −7.8 in float at ξ = 10.
TEST(StressList, hardening_overflow) {
  const Scene scene = snow_scene();
  State state = row_of_particles(6);
  for (Mat3& F : state.particles.F_E) F *= 0.995;
  state.particles.F_P[4] = Vec3(1, 1, in_float() ? -9 : -75).asDiagonal();
  fails("overflow of the hardening", scene, state, 0x1p-14, 4);
}

TEST(StressList, leaving_the_domain) {
  const Scene scene = snow_scene();
  State state = row_of_particles(6);
  state.particles.x[3][0] += 20 * spacing;  // alone: what it does to others is no fault
  state.particles.v[3] = Vec3(0, in_float() ? 1e30 : 1e200, 0);
  fails("a particle leaves the domain", scene, state, 0x1p-10, 3);
  State away = row_of_particles(6);
  away.particles.x[5] = Vec3(0, 0, in_float() ? 1e20 : 1e100);
  fails("a particle is outside the domain", scene, away, 0x1p-10, 5);
}

TEST(StressList, not_a_number_in_the_state) {
  const Scene scene = snow_scene();
  for (const double bad : {nan, std::numeric_limits<double>::infinity()}) {
    const auto with = [&](const char* what, auto change) {
      State state = row_of_particles(6);
      change(state.particles);
      fails(fmt::format("{} in {}", std::isnan(bad) ? "NaN" : "infinity", what), scene, state,
            0x1p-14, 2);
    };
    with("x_p", [&](Particles& p) { p.x[2][1] = bad; });
    with("v_p", [&](Particles& p) { p.v[2][0] = bad; });
    with("F_E", [&](Particles& p) { p.F_E[2](1, 2) = bad; });
    with("F_P", [&](Particles& p) { p.F_P[2](0, 0) = bad; });
    with("m_p", [&](Particles& p) { p.m[2] = bad; });
    with("V_p0", [&](Particles& p) { p.V_0[2] = bad; });
  }
  State state = row_of_particles(6);
  state.particles.m[2] = -1;
  fails("a negative mass", scene, state, 0x1p-14, 2);
}

/// NaN in what one stage left for the next must not come out as a number or go unnoticed.
TEST(StressList, not_a_number_between_stages) {
  const double dt = 0x1p-13;
  const Scene scene = snow_scene();
  State initial = row_of_particles(6);
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
TEST(StressList, small_steps_add_up) {
  const int steps = effort(2000, 5);
  Scene scene = snow_scene();
  State state = row_of_particles(1);
  state.particles.x[0] = Vec3(1, 1, 1);
  state.particles.v[0] = Vec3::Constant(rounded(1e-3));
  const double dt = 1e-5;
  const State after = run_steps(scene, state, steps, dt);
  const double moved = steps * dt * 1e-3;
  // One step is 1.3 spacings of float numbers of the size of a cell: rounding to nearest has it
  // right to half of one.
  within("x = 1, v = 1e-3, Δt = 1e-5 moves",
         (after.particles.x[0] - Vec3::Constant(1 + moved)).norm() / moved,
         in_float() ? 0.5 : 1e-6);

  // A strain rate of 1e-3/s for 2000 steps of 1e-5 s: 1 + 1e-8 is 1 in float.
  Scene soft = scene;
  soft.materials[0] = elastic_material();
  soft.materials[0].youngs_modulus = 1e-9;
  soft.flip = 1;
  State cloud;
  for (int i = 0; i < 512; ++i) {
    State one = row_of_particles(1);
    one.particles.x[0] = spacing / 2 * (Vec3(i / 64, i / 8 % 8, i % 8) + Vec3::Constant(0.5 - 4));
    one.particles.v[0] = rounded(Vec3(1e-3 * one.particles.x[0][0], 0, 0));
    one.particles.id[0] = i;
    cloud.particles.append(one.particles);
  }
  const State stretched = run_steps(soft, cloud, steps, dt);
  const Mat3& F = stretched.particles.F_E[8 * 64 / 2 + 36];
  const double strain = steps * dt * 1e-3;
  // The grid's field is linear but for the free surface, two cells away.
  within("a strain rate of 1e-3 1/s shows", (F(0, 0) - 1 - strain) / strain, 0.2);
}

}  // namespace
}  // namespace firn::suite
