// SPDX-License-Identifier: BSD-3-Clause
/// Ladders of what is small in most scenes: how far a particle goes in a step, over seams and
/// without, and how many materials and colliders there are.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "firn/error.hpp"
#include "verification/suite/probes.hpp"

namespace firn::suite {
namespace {

constexpr double flock_dt = 0x1p-10;

/// Undeformed particles of one velocity: no stress, and the grid moves as they do.
State flock(const Scene& scene, const Vec3& v) {
  State state;
  Particles& p = state.particles;
  p.resize(7);
  for (std::size_t q = 0; q < p.size(); ++q) {
    const double s = static_cast<double>(q);
    p.x[q] = scene.grid.origin + spacing * Vec3(0.375 + s / 2, 0.125 + s / 4, 3.75 - s / 2);
    p.v[q] = v;
    p.m[q] = 1;
    p.V_0[q] = spacing * spacing * spacing;
    p.id[q] = static_cast<std::int64_t>(q);
  }
  return state;
}

/// The flock moves by `cells` in each of two steps: to where it should be, wrapped into the
/// period, or the solver says that it does not go that far.
void moved_by(const std::string& what, const Scene& scene, const Vec3& cells) {
  const State before = flock(scene, rounded(Vec3(spacing / flock_dt * cells)));
  const auto solver = make_subject();
  Particles p = before.particles;
  for (int n = 1; n <= 2; ++n) {
    State after;
    try {
      if (n == 1) solver->load(scene, before);
      solver->step(flock_dt);
      solver->store(after);
    } catch (const SimulationError& error) {
      const bool named = error.subject() == SimulationError::Subject::particle;
      return expect(what + ": right, or an error that names a particle",
                    named && error.stage() == Stage::positions, error.what());
    }
    for (std::size_t q = 0; q < p.size(); ++q) {
      const Vec3 u = n * spacing * cells, x = before.particles.x[q] + u, now = after.particles.x[q];
      Vec3 off = now - x;
      bool inside = true;
      for (int a = 0; a < 3; ++a) {
        const double low = scene.grid.origin[a], period = scene.grid.periodic[a];
        if (period == 0) continue;
        off[a] -= period * std::round(off[a] / period);
        inside = inside && now[a] >= low && now[a] < low + period;
      }
      // v_p has 64 roundings in each step, x a few of its own.
      within(what, off.norm(), n * 64 * eps() * (u.norm() + x.norm() + 4 * spacing),
             fmt::format("particle {} in step {}", q, n));
      expect(what + ": inside the period", inside,
             fmt::format("particle {} at ({}, {}, {})", q, now[0], now[1], now[2]));
    }
  }
}

/// Half a period to ten and a quarter in one step, in both directions, on one axis and on all.
FIRN_TEST(Scale, periods_in_a_step) {
  Scene scene = plain_scene();
  scene.grid.origin = spacing * Vec3(0.25, -0.375, 0.5);
  const Vec3 cells(6, 5, 4);
  scene.grid.periodic = spacing * cells;
  for (const double periods : {0.5, 1.5, 2.5, 10.25})
    for (const double sign : {1.0, -1.0}) {
      if (subject().slow && periods != 1.5) continue;
      const std::string what = fmt::format("{} periods in a step", sign * periods);
      for (int axis = 0; axis < 3; ++axis)
        moved_by(what, scene, sign * periods * cells[axis] * Vec3::Unit(axis));
      moved_by(what, scene, sign * periods * Vec3(cells[0], -cells[1], cells[2]));
    }
}

FIRN_TEST(Scale, cells_in_a_step) {
  const Scene scene = plain_scene();
  for (const double cells : {0.5, 1.5, 2.5, 3.75, 4.5, 16.25, 1000.5})
    for (const double sign : {1.0, -1.0}) {
      if (subject().slow && cells != 1.5 && cells != 16.25) continue;
      moved_by(fmt::format("{} cells in a step", sign * cells), scene,
               sign * cells * Vec3(1, -0.75, 0.5));
    }
}

/// Every lone particle of a material of its own: the stress of an isotropic F_E is known.
FIRN_TEST(Scale, materials) {
  LoneParticles lone(effort(7, 4), 85);
  Scene& scene = lone.scene;
  const double s = 1.0625, J = s * s * s;
  scene.materials.clear();
  for (std::size_t q = 0; q < lone.size(); ++q) {
    Material m = elastic_material();
    m.name = fmt::format("material {}", q);
    m.youngs_modulus = 1e5 * (1 + 0.125 * static_cast<double>(q));
    scene.materials.push_back(m);
    lone.state.particles.material[q] = static_cast<std::int32_t>(q);
    lone.state.particles.F_E[q] = s * Mat3::Identity();
  }
  const std::vector<Mat3> tau = kirchhoff_stresses(lone);
  for (std::size_t q = 0; q < lone.size(); ++q) {
    const Material& m = scene.materials[q];
    const double expected = 2 * m.mu_0() * (s - 1) * s + m.lambda_0() * (J - 1) * J;
    within(fmt::format("stress of {} materials", lone.size()),
           (tau[q] - expected * Mat3::Identity()).norm(),
           measured_stress_roundoff(m, lone.state.particles.F_E[q], Mat3::Identity()), m.name);
  }
}

/// Every lone particle with a sticky box of its own over the nodes beside it, at i + 1 and i + 2:
/// with α = 1 it takes their share of the box's velocity.
FIRN_TEST(Scale, colliders) {
  LoneParticles lone(effort(6, 4), 86);
  Scene& scene = lone.scene;
  Particles& p = lone.state.particles;
  const Vec3 place(0.3125, 0.5, 0.25);  // in the cell
  const double share = static_cast<double>(N(Real(place[0]) - 1) + N(Real(place[0]) - 2));
  for (std::size_t q = 0; q < lone.size(); ++q) {
    Vec3 cell;
    for (int a = 0; a < 3; ++a) cell[a] = std::floor(p.x[q][a] / spacing);
    p.x[q] = spacing * (cell + place);
    Collider box;
    box.shape =
        Box{spacing * (cell + Vec3(0.75, -1.5, -1.5)), spacing * (cell + Vec3(2.5, 2.5, 2.5))};
    box.center = center(box.shape);
    box.sticky = true;
    box.velocity = 0x1p-6 * Vec3(1 + static_cast<double>(q), -2, 3);
    scene.colliders.push_back(box);
  }
  const State after = run_steps(scene, lone.state, 1, 0x1p-13);
  for (std::size_t q = 0; q < lone.size(); ++q) {
    const Vec3 v = share * scene.colliders[q].velocity;
    within(fmt::format("v_p beside {} colliders", lone.size()), (after.particles.v[q] - v).norm(),
           64 * eps() * scene.colliders[q].velocity.norm(), fmt::format("collider {}", q));
  }
}

}  // namespace
}  // namespace firn::suite
