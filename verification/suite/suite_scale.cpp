// SPDX-License-Identifier: BSD-3-Clause
/// Ladders of size: numbers of particles, particles in a cell, distances from the grid's origin.
/// Nothing but the size changes from rung to rung, and the right answer does not.

#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "firn/error.hpp"
#include "verification/suite/copies.hpp"

namespace firn::suite {
namespace {

constexpr double lump_dt = 0x1p-13;
int lump_steps() { return effort(2, 1); }

/// The first n points of a cube of points nine cells apart: out of reach of each other, and at
/// every place within a block of 4 or 8 cells.
std::vector<Vec3> apart(int n) {
  int edge = 1;
  while (edge * edge * edge < n) ++edge;
  std::vector<Vec3> places;
  for (int c = 0; c < n; ++c)
    places.push_back(
        9 * (Vec3(c / (edge * edge), c / edge % edge, c % edge) - Vec3::Constant(edge / 2)));
  return places;
}

void many_lumps(int copies) {
  const Scene scene = lump_scene();
  const State lump = small_lump(101, 4, 12, 81);
  const State alone = run_steps(scene, lump, lump_steps(), lump_dt);
  const std::vector<Vec3> places = apart(copies);
  const State all = run_steps(scene, copies_of(lump, places), lump_steps(), lump_dt);
  const CopyError e =
      compare_copies(scene, lump, alone, places, all.particles, lump_steps(), lump_dt);
  within_all(fmt::format("a lump among {} particles", all.particles.size()), e.numbers, e.in_bounds,
             e.where);
}

/// 909, 9999 and 65 751 particles: more than 65 536, and multiples of no power of two.
FIRN_TEST(Scale, particles) {
  for (const int copies : {9, 99, 651}) {
    if (subject().slow && copies > 99) return;
    many_lumps(copies);
  }
}

/// A million and more.
FIRN_TEST(Scale, long_particles) {
  FIRN_NEEDS_SPEED();
  many_lumps(10001);
}

/// The same bits by any number of threads also where there is work for them.
FIRN_TEST(Scale, threads) {
  const Scene scene = lump_scene();
  const State all = copies_of(small_lump(101, 4, 12, 82), apart(effort(99, 45)));
  const auto run = [&](int threads) {
    const auto solver = subject().create(threads);
    solver->load(scene, all);
    for (int n = 0; n < lump_steps(); ++n) solver->step(lump_dt);
    State state;
    solver->store(state);
    return state.particles;
  };
  const Particles one = run(1), three = run(3);
  std::size_t different = 0;
  for (std::size_t p = 0; p < one.size(); ++p)
    different += std::memcmp(&one.v[p], &three.v[p], sizeof(Vec3)) == 0 &&
                         std::memcmp(&one.F_E[p], &three.F_E[p], sizeof(Mat3)) == 0
                     ? 0
                     : 1;
  expect(fmt::format("{} particles, 3 threads", one.size()), different == 0,
         fmt::format("{} particles differ", different));
}

/// A particle cut into n equal ones at its place: each does what the whole did.
FIRN_TEST(Scale, particles_in_a_cell) {
  const Scene scene = lump_scene();
  const State lump = small_lump(10, 2, 12, 83);
  const State alone = run_steps(scene, lump, lump_steps(), lump_dt);
  for (const int pieces : {16, 128, 1024}) {
    if (subject().slow && pieces > 128) return;
    State cut = copies_of(lump, std::vector<Vec3>(static_cast<std::size_t>(pieces), Vec3::Zero()));
    for (double& m : cut.particles.m) m /= pieces;
    for (double& V : cut.particles.V_0) V /= pieces;
    Particles after = run_steps(scene, cut, lump_steps(), lump_dt).particles;
    for (double& V : after.V_0) V *= pieces;
    const CopyError e = compare_copies(
        scene, lump, alone, std::vector<Vec3>(static_cast<std::size_t>(pieces), Vec3::Zero()),
        after, lump_steps(), lump_dt);
    // A node sums `pieces` times as many terms, one rounding each.
    within_all(fmt::format("particles cut into {}", pieces), e.numbers,
               e.in_bounds / std::max(1.0, pieces / 16.0), e.where);
  }
}

/// A lump at D along every axis, to either side, and beside a corner of that box.
std::vector<Vec3> far_out(double D) {
  std::vector<Vec3> places = {Vec3::Zero(), D * Vec3(1, -1, 1)};
  for (int a = 0; a < 3; ++a)
    for (const double sign : {1.0, -1.0}) places.push_back(sign * D * Vec3::Unit(a));
  return places;
}

/// Copies at D along one axis in a box of 2D nodes along the two others: (i n_y + j) n_z + k of
/// nodes D apart differ by a power of two.
std::vector<Vec3> in_box(double D, int axis, int nodes_of_lump) {
  const double edge = 2 * D - nodes_of_lump;
  return {Vec3::Zero(), D * Vec3::Unit(axis), -D * Vec3::Unit(axis),
          edge * Vec3::Unit((axis + 1) % 3), edge * Vec3::Unit((axis + 2) % 3)};
}

/// Below every copy the same rough table: a place of its own shows where a node was taken to be.
std::vector<Collider> tables(const std::vector<Vec3>& places) {
  std::vector<Collider> list;
  for (const Vec3& place : places) {
    Collider table;
    table.shape =
        Box{spacing * (place - Vec3(3.625, 3.375, 5)), spacing * (place + Vec3(3.5, 3.25, -0.375))};
    table.center = center(table.shape);
    table.friction = 0.3;
    list.push_back(table);
  }
  return list;
}

/// The rungs: 2^10 … 2^24 cells. To 2^20 a solver must go; beyond, it may refuse.
constexpr int must_reach = 20;

void at_distance(int power) {
  // In float 2^power cells leave 23 − power bits for the place in the cell.
  const int bits = in_float() ? std::min(12, 23 - power) : 12, cells = 4;
  const std::string what = fmt::format("a lump at 2^{} cells", power);
  const State lump = small_lump(20, cells, bits, 84);
  const auto judge = [&](const Scene& scene, const State& alone, const std::vector<Vec3>& places) {
    const State all = run_steps(scene, copies_of(lump, places), lump_steps(), lump_dt);
    const CopyError e =
        compare_copies(scene, lump, alone, places, all.particles, lump_steps(), lump_dt);
    within_all(what, e.numbers, e.in_bounds, e.where);
  };
  const double D = std::ldexp(1, power);
  Scene scene = lump_scene();
  const State in_the_open = run_steps(scene, lump, lump_steps(), lump_dt);
  for (int axis = 0; axis < effort(3, 1); ++axis)
    judge(scene, in_the_open, in_box(D, axis, cells + 3));
  if (power > must_reach) return;
  scene.colliders = tables({Vec3::Zero()});
  const State on_its_table = run_steps(scene, lump, lump_steps(), lump_dt);
  scene.colliders = tables(far_out(D));
  judge(scene, on_its_table, far_out(D));
}

FIRN_TEST(Scale, distances) {
  const int last = in_float() ? 23 : 24;  // a float holds whole cells up to there
  for (int power = 10; power <= last; ++power) {
    if (subject().slow && power != 10 && power != 16 && power != must_reach) continue;
    std::string refused;
    try {
      at_distance(power);
    } catch (const InputError& error) {
      refused = error.what();
    } catch (const SimulationError& error) {
      refused = error.what();
    }
    expect(fmt::format("2^{} cells: right{}", power, power > must_reach ? ", or an error" : ""),
           refused.empty() || power > must_reach, refused);
  }
}

}  // namespace
}  // namespace firn::suite
