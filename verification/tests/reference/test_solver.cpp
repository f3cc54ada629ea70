// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <stdexcept>
#include <string>

#include "firn/error.hpp"
#include "verification/tests/reference/scenes.hpp"

namespace firn {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
const double nan = std::numeric_limits<double>::quiet_NaN();

/// Snow on a rough floor beside a moving wall, one axis periodic, one particle
/// exactly on a node (so that nodes of zero mass exist) and two coincident ones.
Scene busy_scene(bool implicit = false) {
  Scene scene = test::empty_scene();
  scene.gravity = Vec3(0, 0, -9.81);
  scene.grid.periodic = Vec3(0, 0.8, 0);
  Collider floor, wall;
  floor.shape = HalfSpace{Vec3(0, 0, -0.21), Vec3::UnitZ()};
  floor.friction = 0.3;
  wall.shape = HalfSpace{Vec3(-0.31, 0, 0), Vec3::UnitX()};
  wall.velocity = Vec3(0.5, 0, 0);
  scene.colliders = {floor, wall};
  if (implicit) {
    scene.integrator.type = IntegratorType::semi_implicit;
    scene.integrator.tolerance = 1e-6;
  }
  return scene;
}

State busy_state(const Scene& scene) {
  State state = test::random_particles(scene, 120, 6, 1);
  for (Vec3& x : state.particles.x) x = scene.wrap(x);
  state.particles.x[5] = Vec3(0, 0, 0);
  state.particles.x[7] = state.particles.x[8];
  state.particles.V_0[9] = 1e-4;
  return state;
}

const auto expect_equal = [](const char* name, const auto& a, const auto& b) {
  EXPECT_EQ(a, b) << name;
};

void expect_same(const Particles& a, const Particles& b) { for_each_field(expect_equal, a, b); }

void expect_same(const Grid& a, const Grid& b) {
  EXPECT_EQ(a.node, b.node);
  for_each_field(expect_equal, a, b);
}

class ReferenceSolver : public testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Integrator, ReferenceSolver, testing::Bool(), [](const auto& info) {
  return std::string(info.param ? "semi_implicit" : "explicit_euler");
});

/// Stopped after each of the ten stages, stored, and loaded into another solver:
/// the same bits as three whole steps.
TEST_P(ReferenceSolver, StagesOneByOneEqualWholeSteps) {
  const Scene scene = busy_scene(GetParam());
  const double dt = 1e-3;
  auto whole = test::make_reference();
  whole->load(scene, busy_state(scene));
  State expected, state = busy_state(scene);
  for (int step = 0; step < 3; ++step) {
    const StepReport report = whole->step(dt);
    EXPECT_EQ(report.dt, dt);
    EXPECT_EQ(report.solver_iterations > 0, GetParam());
    for (const Stage stage : all_stages) {
      auto fresh = test::make_reference();
      EXPECT_EQ(state.next, stage);
      fresh->load(scene, state);
      State untouched;
      fresh->store(untouched);
      expect_same(untouched.grid, stage == Stage::rasterize ? Grid{} : state.grid);
      const StepReport staged = fresh->advance_through(stage, dt);
      EXPECT_EQ(staged.grid_nodes, report.grid_nodes);
      fresh->store(state);
      EXPECT_EQ(static_cast<std::int64_t>(state.grid.size()), report.grid_nodes);
      EXPECT_EQ(state.dt, stage == Stage::positions ? 0 : dt);
    }
    whole->store(expected);
    expect_same(state.particles, expected.particles);
    expect_same(state.grid, expected.grid);
    EXPECT_EQ(state.time, expected.time);
    EXPECT_EQ(state.step, step + 1);
  }
}

TEST_P(ReferenceSolver, WritesTheFieldsOfEachStage) {
  const Scene scene = busy_scene(GetParam());
  auto solver = test::make_reference();
  solver->load(scene, busy_state(scene));
  State s;
  for (const Stage stage : all_stages) {
    solver->advance_through(stage, 1e-3);
    solver->store(s);
    const std::size_t n = s.grid.size();
    EXPECT_TRUE(std::is_sorted(s.grid.node.begin(), s.grid.node.end()));
    EXPECT_TRUE(std::all_of(s.grid.m.begin(), s.grid.m.end(), [](double m) { return m > 0; }));
    EXPECT_EQ(s.grid.v.size(), n);
    EXPECT_EQ(s.grid.f.size(), number(stage) >= 3 ? n : 0);
    EXPECT_EQ(s.grid.v_star.size(), number(stage) >= 4 ? n : 0);
    EXPECT_EQ(s.grid.free_directions.size(), number(stage) >= 5 && GetParam() ? n : 0);
    EXPECT_EQ(s.grid.v_new.size(), number(stage) >= 6 ? n : 0);
  }
}

/// The same result whatever the solver did before, and twice in a row.
TEST_P(ReferenceSolver, IsAFunctionOfItsState) {
  const Scene scene = busy_scene(GetParam()), other = test::empty_scene();
  auto used = test::make_reference(), fresh = test::make_reference();
  used->load(other, test::random_particles(other, 500, 9, 3));
  used->step(1e-4);
  used->advance_through(Stage::grid_forces, 1e-4);
  State a, b;
  for (Solver* solver : {used.get(), fresh.get()}) {
    solver->load(scene, busy_state(scene));
    solver->step(1e-3);
  }
  used->store(a);
  fresh->store(b);
  expect_same(a.particles, b.particles);
}

/// A value that is not finite, put into one field before one stage.
struct Poison {
  std::string name;
  Stage stage;
  SimulationError::Subject subject;
  std::function<void(State&)> inject;
  /// Where the error shows: the particle, or any node (−1).
  std::int64_t index;
};

constexpr auto particle = SimulationError::Subject::particle;
constexpr auto node = SimulationError::Subject::node;

std::vector<Poison> poisons() {
  return {
      {"mass", Stage::rasterize, particle, [](State& s) { s.particles.m[3] = nan; }, 3},
      {"no_mass", Stage::rasterize, particle, [](State& s) { s.particles.m[3] = 0; }, 3},
      {"position", Stage::rasterize, particle, [](State& s) { s.particles.x[4][1] = nan; }, 4},
      {"domain", Stage::rasterize, particle, [](State& s) { s.particles.x[4][2] = 1e12; }, 4},
      {"velocity", Stage::rasterize, particle, [](State& s) { s.particles.v[5][0] = infinity; }, 5},
      {"volume", Stage::volumes, particle, [](State& s) { s.particles.V_0[6] = nan; }, 6},
      {"negative_volume", Stage::volumes, particle, [](State& s) { s.particles.V_0[6] = -1; }, 6},
      {"F_E", Stage::grid_forces, particle, [](State& s) { s.particles.F_E[7](1, 2) = nan; }, 7},
      {"F_P", Stage::grid_forces, particle, [](State& s) { s.particles.F_P[8](0, 0) = nan; }, 8},
      {"hardening", Stage::grid_forces, particle,
       [](State& s) { s.particles.F_P[8] = Vec3(-80, 1, 1).asDiagonal(); }, 8},
      {"large_stress", Stage::grid_forces, particle,
       [](State& s) { s.particles.F_E[8] = Vec3(1e200, 1, 1).asDiagonal(); }, 8},
      {"force", Stage::grid_velocities, node, [](State& s) { s.grid.f[9][2] = nan; }, 9},
      {"v_star", Stage::grid_collisions, node, [](State& s) { s.grid.v_star[9][2] = nan; }, 9},
      {"v_star_later", Stage::integration, node, [](State& s) { s.grid.v_star[9][2] = nan; }, 9},
      {"v_new", Stage::deformation, particle, [](State& s) { s.grid.v_new[9][2] = nan; }, -1},
      {"F_E_later", Stage::deformation, particle,
       [](State& s) { s.particles.F_E[7](1, 2) = -infinity; }, 7},
      {"v_n", Stage::particle_velocities, particle, [](State& s) { s.grid.v[9][2] = nan; }, -1},
      {"v_p", Stage::particle_collisions, particle, [](State& s) { s.particles.v[2][0] = nan; }, 2},
      {"overflow", Stage::positions, particle, [](State& s) { s.particles.v[2][0] = infinity; }, 2},
  };
}

class NotFinite : public testing::TestWithParam<Poison> {};

INSTANTIATE_TEST_SUITE_P(Poisons, NotFinite, testing::ValuesIn(poisons()),
                         [](const auto& info) { return info.param.name; });

/// The step fails as a whole, says where, and leaves what was loaded.
TEST_P(NotFinite, IsReportedWithStageAndPlace) {
  const Poison& poison = GetParam();
  const Scene scene = busy_scene();
  auto solver = test::make_reference();
  State state = busy_state(scene);
  solver->load(scene, state);
  if (poison.stage != Stage::rasterize) {
    solver->advance_through(static_cast<Stage>(number(poison.stage) - 1), 1e-3);
    solver->store(state);
  }
  poison.inject(state);
  solver->load(scene, state);
  try {
    solver->advance_through(Stage::positions, 1e-3);
    FAIL() << "went through";
  } catch (const SimulationError& error) {
    EXPECT_EQ(error.stage(), poison.stage) << error.what();
    EXPECT_EQ(error.subject(), poison.subject) << error.what();
    if (poison.index >= 0) {
      EXPECT_EQ(error.index(), poison.index) << error.what();
    }
    EXPECT_NE(std::string(error.what()).find(name(poison.stage)), std::string::npos);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    EXPECT_TRUE(error.state_intact);
  }
  State after;
  solver->store(after);
  EXPECT_EQ(after.next, state.next);
  EXPECT_EQ(after.time, state.time);
  EXPECT_EQ(after.particles.x[0], state.particles.x[0]);
  EXPECT_EQ(after.particles.F_E[0], state.particles.F_E[0]);
  EXPECT_EQ(after.particles.v[0], state.particles.v[0]);
  EXPECT_EQ(after.grid.node, state.next == Stage::rasterize ? Grid{}.node : state.grid.node);
}

/// A failed step leaves the state before it, and a smaller step goes on from there.
TEST(Failure, LeavesTheStateBeforeTheStep) {
  Scene scene = busy_scene();
  scene.gravity = Vec3(0, 0, -1e300);
  auto solver = test::make_reference();
  solver->load(scene, busy_state(scene));
  solver->step(1e-310);
  State before, after;
  solver->store(before);
  EXPECT_THROW(solver->step(1e300), SimulationError);
  solver->store(after);
  expect_same(before.particles, after.particles);
  EXPECT_EQ(before.time, after.time);
  EXPECT_EQ(before.step, after.step);
  EXPECT_EQ(after.next, Stage::rasterize);
  EXPECT_EQ(after.dt, 0);
  EXPECT_NO_THROW(solver->step(1e-310));
}

/// Found by the step that takes the particle there, so that the last good state
/// is one from which a smaller step can go on.
TEST(Failure, ParticlesThatLeaveTheDomain) {
  const Scene scene = test::empty_scene();
  State state = test::particles_at_rest(scene, 2);
  state.particles.v[1] = Vec3(1e9, 0, 0);
  auto solver = test::make_reference();
  solver->load(scene, state);
  solver->step(1e-4);
  State before, after;
  solver->store(before);
  try {
    solver->step(1);  // 5e9 cells
    FAIL() << "went through";
  } catch (const SimulationError& error) {
    EXPECT_EQ(error.stage(), Stage::positions);
    EXPECT_EQ(error.subject(), particle);
    EXPECT_TRUE(error.state_intact);
  }
  solver->store(after);
  expect_same(after.particles, before.particles);
  EXPECT_NO_THROW(solver->step(1e-4));
}

TEST(Extremes, ParticlesMayCrossManyCellsInAStep) {
  const Scene scene = test::empty_scene();
  State state = test::particles_at_rest(scene);
  state.particles.v[0] = Vec3(1000, -2000, 0);
  auto solver = test::make_reference();
  solver->load(scene, state);
  solver->step(0.25);
  solver->store(state);
  EXPECT_LE((state.particles.x[0] - Vec3(250.05, -499.95, 0.05)).norm(), 1e-12);
  EXPECT_NO_THROW(solver->step(0.25));
}

TEST(Extremes, NoParticles) {
  const Scene scene = test::empty_scene();
  auto solver = test::make_reference();
  solver->load(scene, State{});
  EXPECT_EQ(solver->step(1e-4).grid_nodes, 0);
  EXPECT_EQ(solver->diagnostics(scene).mass, 0);
  State state;
  solver->store(state);
  EXPECT_EQ(state.step, 1);
}

TEST(Extremes, CoincidentParticlesStayTogether) {
  const Scene scene = test::empty_scene();
  State state = test::particles_at_rest(scene, 3);
  for (Vec3& v : state.particles.v) v = Vec3(1, 2, 3);
  for (Mat3& F : state.particles.F_E) F = 0.99 * Mat3::Identity();
  auto solver = test::make_reference();
  solver->load(scene, state);
  for (int step = 0; step < 20; ++step) solver->step(1e-4);
  solver->store(state);
  EXPECT_EQ(state.particles.x[0], state.particles.x[1]);
  EXPECT_EQ(state.particles.F_E[0], state.particles.F_E[2]);
}

TEST(Input, IsChecked) {
  const Scene scene = test::empty_scene();
  State state = test::particles_at_rest(scene, 2);
  auto solver = test::make_reference();
  solver->load(scene, state);
  for (const double dt : {0.0, -1.0, nan, infinity}) EXPECT_THROW(solver->step(dt), InputError);
  solver->advance_through(Stage::grid_forces, 1e-4);
  EXPECT_THROW(solver->advance_through(Stage::volumes, 1e-4), std::logic_error);

  state.particles.material[1] = 1;
  EXPECT_THROW(solver->load(scene, state), InputError);
  state.particles.material[1] = -1;
  EXPECT_THROW(solver->load(scene, state), InputError);
  state.particles.material[1] = 0;
  state.particles.v.pop_back();
  EXPECT_THROW(solver->load(scene, state), InputError);

  EXPECT_THROW(make_reference_solver({Precision::float32, 1}), InputError);
}

TEST(Input, RegistryEntry) {
  Registry registry;
  registry.add(reference_entry());
  const auto solver = registry.create("reference", {Precision::float64, 8});
  EXPECT_EQ(solver->traits().name, "reference");
  EXPECT_EQ(solver->traits().stops.size(), static_cast<std::size_t>(stage_count));
  EXPECT_TRUE(solver->traits().semi_implicit);
  EXPECT_TRUE(solver->traits().explicit_euler);
  EXPECT_EQ(registry.traits("reference").semi_implicit, solver->traits().semi_implicit);
}

TEST(Diagnostics, AgreeWithThoseOfTheInterface) {
  const Scene scene = busy_scene();
  auto solver = test::make_reference();
  solver->load(scene, busy_state(scene));
  solver->step(1e-3);
  State state;
  solver->store(state);
  const Diagnostics own = solver->diagnostics(scene), other = measure(scene, state);
  EXPECT_EQ(own.time, other.time);
  EXPECT_EQ(own.mass, other.mass);
  EXPECT_EQ(own.momentum, other.momentum);
  EXPECT_EQ(own.angular_momentum, other.angular_momentum);
  EXPECT_EQ(own.kinetic_energy, other.kinetic_energy);
  EXPECT_EQ(own.gravitational_energy, other.gravitational_energy);
  EXPECT_EQ(own.center_of_mass, other.center_of_mass);
  EXPECT_EQ(own.max_speed, other.max_speed);
  EXPECT_EQ(own.min_J_E, other.min_J_E);
  EXPECT_EQ(own.max_J_E, other.max_J_E);
  // Another SVD: (σ − 1)² with σ − 1 = 1e-2 known to 1e-16 is good to 1e-13 or so.
  EXPECT_NEAR(own.elastic_energy, other.elastic_energy, 1e-12 * other.elastic_energy);
  EXPECT_GT(solver->bytes_per_particle(), 400);
}

class TimeStepRule : public testing::Test {
 protected:
  TimeStepRule() {
    scene_.time.adaptive = true;
    scene_.time.max_step = 1;
    scene_.time.cfl = 0.5;
    scene_.time.elastic_cfl = 0.25;
    state_ = test::particles_at_rest(scene_, 2);
  }
  TimeStep choose() {
    auto solver = test::make_reference();
    solver->load(scene_, state_);
    return solver->choose_time_step();
  }
  Scene scene_ = test::empty_scene();
  State state_;
};

TEST_F(TimeStepRule, Fixed) {
  scene_.time.adaptive = false;
  scene_.time.step = 0.125;
  EXPECT_EQ(choose().dt, 0.125);
  EXPECT_EQ(choose().bound, TimeStepBound::fixed);
}

TEST_F(TimeStepRule, ElasticBoundOfTheMaterial) {
  // V_p0 is not known: ρ = 400, λ + 2μ = 38889 + 116667 Pa
  const double c = std::sqrt((1.4e5 * 0.2 / 0.72 + 1.4e5 / 1.2) / 400);
  EXPECT_DOUBLE_EQ(choose().dt, 0.25 * 0.1 / c);
  EXPECT_EQ(choose().bound, TimeStepBound::elastic_cfl);
}

TEST_F(TimeStepRule, ElasticBoundOfTheDensestAndHardest) {
  const double unhardened = choose().dt;
  state_.particles.m[1] = 4;
  state_.particles.V_0[1] = 4.0 / 100;  // ρ = 100: sound is twice as fast
  EXPECT_DOUBLE_EQ(choose().dt, unhardened / 2);
  state_.particles.F_P[1] = Vec3(0.9, 1, 1).asDiagonal();  // e^{10·0.1} stiffer
  EXPECT_DOUBLE_EQ(choose().dt, unhardened / 2 / std::exp(0.5));
}

TEST_F(TimeStepRule, FastParticles) {
  state_.particles.v[1] = Vec3(300, 0, 400);
  EXPECT_DOUBLE_EQ(choose().dt, 0.5 * 0.1 / 500);
  EXPECT_EQ(choose().bound, TimeStepBound::cfl);
}

TEST_F(TimeStepRule, LargestStep) {
  scene_.time.max_step = 1e-6;
  EXPECT_EQ(choose().dt, 1e-6);
  EXPECT_EQ(choose().bound, TimeStepBound::max_step);
}

TEST_F(TimeStepRule, SemiImplicitHasNoElasticBound) {
  scene_.integrator.type = IntegratorType::semi_implicit;
  EXPECT_EQ(choose().dt, 1);
  EXPECT_EQ(choose().bound, TimeStepBound::max_step);
}

TEST_F(TimeStepRule, NotFinite) {
  state_.particles.v[1][2] = nan;
  EXPECT_THROW(choose(), SimulationError);
  state_.particles.v[1][2] = 0;
  state_.particles.F_P[0] = Vec3(-100, 1, 1).asDiagonal();
  try {
    choose();
    FAIL();
  } catch (const SimulationError& error) {
    EXPECT_EQ(error.index(), 0);
    EXPECT_TRUE(error.state_intact);
  }
}

}  // namespace
}  // namespace firn
