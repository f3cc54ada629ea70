// SPDX-License-Identifier: BSD-3-Clause
/// A wall on a plane of nodes: φ = 0 there, and a solver's rounding decides what touches.
/// Whatever it decides is right; what it does then is not beyond judgement.

#include <gtest/gtest.h>

#include "verification/check/check.hpp"
#include "verification/check/contact_kind.hpp"
#include "verification/tests/check/solvers.hpp"

namespace firn::test {
namespace {

constexpr double h = 0.1;
const std::vector<Stage> whole{Stage::positions};

/// A block that slides over the floor z = 0, with contact in its 20th step.
Scene block_on_grid_plane() {
  Scene scene;
  scene.name = "block";
  scene.gravity = {0, 0, -9.81};
  scene.grid.spacing = h;
  scene.time.step = 5e-4;
  scene.time.end = 1;
  scene.materials.emplace_back();
  Body body;
  body.shape = Box{{0, 0, 0.05}, {0.2, 0.2, 0.25}};
  body.seed = 3;
  body.velocity = {2, 0, -4};
  scene.bodies = {body};
  Collider floor;
  floor.shape = HalfSpace{Vec3::Zero(), Vec3::UnitZ()};
  floor.friction = 0.4;
  scene.colliders = {floor};
  return scene;
}

Scene implicit_block() {
  Scene scene = block_on_grid_plane();
  scene.integrator.type = IntegratorType::semi_implicit;
  scene.integrator.tolerance = 1e-10;
  return scene;
}

bool on_floor(const NodeIndex& n) { return n.k == 0; }
bool every_second(const NodeIndex& n) { return (n.i + n.j) % 2 == 0; }
bool every(const NodeIndex&) { return true; }

/// Takes these nodes of the floor for free, which the reference takes for touching.
template <class Which>
Mistake free_nodes(Which which, int& count) {
  return [which, &count](const StageRun& run) {
    for (std::size_t i = 0; i < run.after.grid.size(); ++i) {
      const NodeIndex& n = run.after.grid.node[i];
      if (!on_floor(n) || !which(n)) continue;
      count += run.after.grid.v_star[i] != run.before.grid.v_star[i];
      run.after.grid.v_star[i] = run.before.grid.v_star[i];
      if (run.scene.semi_implicit()) run.after.grid.free_directions[i].setIdentity();
    }
  };
}

/// Forgets friction, at the nodes of the floor alone.
void no_friction(const StageRun& run) {
  for (std::size_t i = 0; i < run.after.grid.size(); ++i)
    if (on_floor(run.after.grid.node[i]) && run.before.grid.v_star[i][2] < 0) {
      run.after.grid.v_star[i] = run.before.grid.v_star[i];
      run.after.grid.v_star[i][2] = 0;
    }
}

/// Any solver, with whole steps alone.
class WholeSteps final : public Solver {
 public:
  explicit WholeSteps(std::unique_ptr<Solver> inner)
      : inner_(std::move(inner)), traits_(inner_->traits()) {
    traits_.stops = whole;
  }
  const SolverTraits& traits() const override { return traits_; }
  void load(const Scene& scene, const State& state) override { inner_->load(scene, state); }
  TimeStep choose_time_step() override { return inner_->choose_time_step(); }
  StepReport advance_through(Stage, double dt) override { return inner_->step(dt); }
  void store(State& state) const override { inner_->store(state); }

 private:
  std::unique_ptr<Solver> inner_;
  SolverTraits traits_;
};

CheckReport check_block(const Scene& scene, Solver& subject, std::int64_t steps = 3) {
  const auto reference = make_reference();
  return run_check(scene, *reference, subject, {.steps = steps, .start_step = 20});
}

bool contact_not_judged(const CheckReport& report) {
  return std::any_of(report.not_judged.begin(), report.not_judged.end(), [](const NotJudged& each) {
    return each.what.find("contact") != std::string::npos;
  });
}

const std::vector<std::vector<Stage>> ways_to_stop{
    {}, whole, {Stage::grid_velocities, Stage::positions}, {Stage::integration, Stage::positions}};

TEST(DoubtfulContact, EverySolverIsValidStagedAndInWholeSteps) {
  for (const Scene& scene : {block_on_grid_plane(), implicit_block()})
    for (const SolverEntry& entry : builtin_registry().entries())
      for (const Precision precision : entry.precisions) {
        SCOPED_TRACE(entry.name + " " + std::string(name(precision)));
        SolverOptions options;
        options.precision = precision;
        const auto staged = builtin_registry().create(entry.name, options);
        const CheckReport report = check_block(scene, *staged);
        EXPECT_TRUE(report.valid()) << to_table(report);
        EXPECT_FALSE(contact_not_judged(report)) << to_table(report);
        WholeSteps in_one(builtin_registry().create(entry.name, options));
        const CheckReport together = check_block(scene, in_one);
        EXPECT_TRUE(together.valid()) << to_table(together);
        EXPECT_FALSE(contact_not_judged(together)) << to_table(together);
      }
}

TEST(DoubtfulContact, RoundingTheOtherWayIsValidAndJudged) {
  for (const auto& stops : ways_to_stop)
    for (const bool all : {false, true}) {
      int freed = 0;
      Mistaken subject(Stage::grid_collisions,
                       all ? free_nodes(every, freed) : free_nodes(every_second, freed), stops);
      const CheckReport report = check_block(block_on_grid_plane(), subject);
      EXPECT_TRUE(report.valid()) << to_table(report);
      EXPECT_FALSE(contact_not_judged(report)) << to_table(report);
      EXPECT_GT(freed, 0);
    }
}

TEST(DoubtfulContact, NoFrictionOnTheFloorIsInvalid) {
  for (const Scene& scene : {block_on_grid_plane(), implicit_block()})
    for (const auto& stops : ways_to_stop) {
      if (scene.semi_implicit() && stops.size() < stage_count && !stops.empty() &&
          stops.front() != Stage::integration)
        continue;  // not judged, see below
      Mistaken subject(Stage::grid_collisions, no_friction, stops);
      const CheckReport report = check_block(scene, subject);
      EXPECT_FALSE(report.valid()) << to_table(report);
    }
}

TEST(DoubtfulContact, ParticlesOnTheSurfaceAreJudged) {
  const Scene scene = block_on_grid_plane();
  State state = initial_state(scene);
  for (std::size_t p = 0; p < 20; ++p) state.particles.x[p][2] = 0;
  const auto result = [&](const std::vector<Stage>& stops, const Mistake& mistake) {
    Mistaken subject(Stage::particle_collisions, mistake, stops);
    const auto reference = make_reference();
    return run_check(scene, state, *reference, subject, {.steps = 1});
  };
  const Mistake free_odd = [](const StageRun& run) {
    for (std::size_t p = 1; p < 20; p += 2) {
      EXPECT_NE(run.after.particles.v[p], run.before.particles.v[p]);
      run.after.particles.v[p] = run.before.particles.v[p];
    }
  };
  const Mistake frictionless = [](const StageRun& run) {
    for (std::size_t p = 0; p < 20; ++p) {
      run.after.particles.v[p] = run.before.particles.v[p];
      run.after.particles.v[p][2] = 0;
    }
  };
  for (const auto& stops : ways_to_stop) {
    const CheckReport right = result(stops, free_odd);
    EXPECT_TRUE(right.valid()) << to_table(right);
    EXPECT_FALSE(contact_not_judged(right));
    EXPECT_FALSE(result(stops, frictionless).valid());
  }
}

TEST(DoubtfulContact, TheImplicitSolveHoldsWhatTheSubjectTookForTouching) {
  for (const auto& stops : ways_to_stop) {
    const bool readable = stops.empty() || stops.front() == Stage::integration;
    for (const bool all : {false, true}) {
      int freed = 0;
      Mistaken subject(Stage::grid_collisions,
                       all ? free_nodes(every, freed) : free_nodes(every_second, freed), stops);
      const CheckReport report = check_block(implicit_block(), subject);
      EXPECT_TRUE(report.valid()) << to_table(report);
      EXPECT_GT(freed, 0);
      // The solve spreads a choice over all nodes: with whole steps alone a mixture of choices
      // cannot be read off the particles.
      EXPECT_EQ(contact_not_judged(report), !readable && !all) << to_table(report);
    }
  }
}

TEST(DoubtfulContact, WhatAParticleAloneDoesNotTellIsNotJudged) {
  const Scene scene = block_on_grid_plane();
  State state = initial_state(scene);
  state.particles.resize(1);
  state.particles.x[0] = {0.53 * h, 0.41 * h, 0.37 * h};
  const auto run = [&](int& freed, bool all) {
    Mistaken subject(Stage::grid_collisions,
                     all ? free_nodes(every, freed) : free_nodes(every_second, freed), whole);
    const auto reference = make_reference();
    return run_check(scene, state, *reference, subject, {.steps = 1});
  };
  int freed = 0;
  const CheckReport mixed = run(freed, false), alike = run(freed, true);
  EXPECT_GT(freed, 16);
  EXPECT_TRUE(mixed.valid()) << to_table(mixed);
  EXPECT_TRUE(contact_not_judged(mixed));
  EXPECT_NE(not_judged_text(mixed).find("collider 1"), std::string::npos);
  EXPECT_TRUE(alike.valid()) << to_table(alike);
  EXPECT_FALSE(contact_not_judged(alike));
}

TEST(NotJudged, UnstrainedSnowHasNoForceToJudge) {
  Scene scene = block_on_grid_plane();
  scene.colliders.clear();
  const auto reference = make_reference(), subject = make_reference();
  const CheckReport report = run_check(scene, *reference, *subject, {.steps = 1});
  ASSERT_EQ(report.not_judged.size(), 1u) << to_table(report);
  const NotJudged& forces = report.not_judged[0];
  EXPECT_NE(forces.what.find("f_i of "), std::string::npos);
  EXPECT_EQ(forces.numbers, 3 * forces.places);
  for (const FieldCheck& row : report.fields)
    if (row.field == Field::node_force) {
      EXPECT_EQ(row.compared, 0);
    }
}

TEST(NotJudged, BeyondAWideBoundANumberIsWrongAllTheSame) {
  Scene scene = block_on_grid_plane();
  scene.colliders.clear();
  Mistaken subject(Stage::grid_forces, [](const StageRun& run) { run.after.grid.f[7][1] = 1; });
  const auto reference = make_reference();
  const CheckReport report = run_check(scene, *reference, subject, {.steps = 1});
  ASSERT_FALSE(report.valid());
  EXPECT_EQ(report.first_divergence->field, Field::node_force);
}

}  // namespace
}  // namespace firn::test
