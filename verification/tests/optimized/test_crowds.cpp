// SPDX-License-Identifier: BSD-3-Clause
// The semi-implicit operator works on slabs of a block's cells, in vectors, in batches and
// in pairs of neighbours: here are the crowds whose ends fall everywhere.

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <gtest/gtest.h>
#include <numeric>
#include <string>
#include <vector>

#include "optimized/optimized_solver.hpp"
#include "solvers/solvers.hpp"
#include "verification/check/check.hpp"
#include "verification/support/snow_cases.hpp"
#include "verification/tests/optimized/snow_scenes.hpp"

namespace firn::test {
namespace {

/// How many particles lie in which cells of a 4 × 4 × 4 block: counts[k] in cells[k], a cell
/// being 16 x + 4 y + z.
struct Crowd {
  const char* name;
  std::vector<int> cells, counts;
};

std::vector<Crowd> crowds() {
  std::vector<Crowd> all = {
      {"one particle", {0}, {1}},
      {"one in the last cell", {63}, {1}},
      {"a pair", {21}, {2}},
      // Batches of 16, pages and vectors of up to 16: one less, all, one more.
      {"15 in a cell", {5}, {15}},
      {"16 in a cell", {5}, {16}},
      {"17 in a cell", {42}, {17}},
      {"33 in a cell", {63}, {33}},
      {"100 in a cell", {22}, {100}},
      {"empty slabs between", {3, 60}, {9, 11}},
      {"empty slabs around", {16, 31}, {21, 10}},
      {"one in each slab", {15, 16, 47, 48}, {1, 1, 1, 1}},
      {"no slab ends with a vector", {0, 13, 20, 31, 32, 47, 50, 63}, {3, 2, 5, 18, 1, 12, 7, 9}},
      {"every slab ends with a vector", {7, 17, 30, 40, 63}, {32, 16, 16, 32, 16}},
      {"slabs of one vector and one", {0, 16, 32, 48}, {17, 17, 17, 17}},
      // It reaches into 48 places: the most that 31 particles can need on 512 bits in float.
      {"a slab that begins and ends inside of vectors", {15, 21, 42}, {15, 31, 9}},
      {"odd neighbours", {}, {}}};
  all.back().cells.resize(64);
  std::iota(all.back().cells.begin(), all.back().cells.end(), 0);
  for (int c = 0; c < 64; ++c) all.back().counts.push_back(1 + c % 3);
  return all;
}

/// Deformed snow in these cells of the block at the origin, every particle another one, in an
/// order that is none of cells. `periodic`: in a world of one block.
struct CrowdedSnow {
  CrowdedSnow(const Crowd& crowd, bool periodic) {
    const double h = scene.grid.spacing = 0.1;
    scene.time.step = 2e-3;
    if (periodic) scene.grid.periodic = Vec3::Constant(4 * h);
    scene.materials.push_back(Material{});
    scene.integrator = {IntegratorType::semi_implicit, 1, 1e-9, 2000};
    fixtures::Random random(7);
    std::vector<int> cell_of;
    for (std::size_t k = 0; k < crowd.cells.size(); ++k)
      cell_of.insert(cell_of.end(), static_cast<std::size_t>(crowd.counts[k]), crowd.cells[k]);
    const std::size_t n = cell_of.size();
    Particles& p = state.particles;
    p.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      // A stride that shares no factor with n visits all.
      std::size_t stride = n / 2 + 1;
      while (std::gcd(stride, n) != 1) ++stride;
      const int c = cell_of[i * stride % n];
      p.x[i] = h * (Vec3(c / 16, c / 4 % 4, c % 4) + Vec3::Constant(0.5) + 0.499 * random.vec3());
      fixtures::random_particle(random, h, p, i);
    }
  }
  Scene scene;
  State state;
};

class Crowds : public testing::Test {
 protected:
  void TearDown() override { unsetenv("FIRN_TARGET"); }

  static void choose(std::string target) {
    for (char& c : target) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    ASSERT_EQ(setenv("FIRN_TARGET", target.c_str(), 1), 0);
  }
};

TEST_F(Crowds, AreSolvedOnEveryInstructionSet) {
  Registry registry;
  register_solvers(registry);
  const auto reference = registry.create("reference", {});
  for (const std::string& target : optimized_targets()) {
    choose(target);
    EXPECT_EQ(optimized_target_name(), target);
    for (const Crowd& crowd : crowds())
      for (const bool periodic : {false, true}) {
        const CrowdedSnow snow(crowd, periodic);
        for (const Precision precision : {Precision::float64, Precision::float32}) {
          const auto solver = optimized(precision);
          const CheckReport report =
              run_check(snow.scene, snow.state, *reference, *solver, {.steps = 1});
          EXPECT_TRUE(report.valid()) << target << ", " << crowd.name << ", " << name(precision)
                                      << (periodic ? ", periodic\n" : "\n") << to_table(report);
        }
      }
  }
}

/// Scratch memory that served a crowd serves the next one: what the first left in it, in
/// spare lanes and in slabs that are empty now, is nothing to the second.
TEST_F(Crowds, LeaveNothingBehind) {
  for (const std::string& target : optimized_targets()) {
    choose(target);
    for (const Precision precision : {Precision::float64, Precision::float32}) {
      const auto used = optimized(precision);
      for (const Crowd& crowd : crowds()) {
        const CrowdedSnow snow(crowd, false);
        State after_others, alone;
        const auto fresh = optimized(precision);
        used->load(snow.scene, snow.state);
        fresh->load(snow.scene, snow.state);
        for (Solver* solver : {used.get(), fresh.get()}) solver->step(snow.scene.time.step);
        used->store(after_others);
        fresh->store(alone);
        EXPECT_TRUE(same_bits(after_others, alone)) << target << ", " << crowd.name;
      }
    }
  }
}

}  // namespace
}  // namespace firn::test
