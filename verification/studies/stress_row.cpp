// SPDX-License-Identifier: BSD-3-Clause
/// Situations of rows of particles; every number is exact in float.

#include <cmath>
#include <limits>

#include "verification/studies/stress_list.hpp"
#include "verification/support/scenes.hpp"

namespace firn::studies {

namespace {

Situation situation(const std::string& name, Expected expected, const State& state, double dt,
                    int steps = 1) {
  return {.name = name,
          .expected = expected,
          .scene = row_scene(),
          .state = state,
          .dt = dt,
          .steps = steps};
}

/// One step of six particles, which must stop because of particle `culprit`.
template <class Change>
Situation spoiled(const std::string& name, std::int64_t culprit, double dt, const Change& change) {
  State state = row_of_particles(6);
  change(state.particles, static_cast<std::size_t>(culprit));
  Situation s = situation(name, Expected::stops, state, dt);
  s.culprit = culprit;
  return s;
}

}  // namespace

Scene row_scene() {
  Scene scene = fixtures::elastic_scene("suite", row_spacing, 1e-4);
  scene.flip = 0.95;
  scene.materials = {Material{}};
  scene.materials[0].name = "snow";
  return scene;
}

State row_of_particles(std::size_t n) {
  State state;
  Particles& p = state.particles;
  p.resize(n);
  for (std::size_t q = 0; q < n; ++q) {
    p.x[q] = row_spacing * Vec3(0.25 * static_cast<double>(q) + 0.125, 0.5, -0.75);
    p.m[q] = 0x1p-6;
    p.V_0[q] = 0x1p-15;
    p.id[q] = static_cast<std::int64_t>(q);
  }
  return state;
}

std::vector<Situation> few_in_a_row(int steps) {
  std::vector<Situation> list;
  for (const std::size_t n : {1u, 2u, 3u}) {
    State state = row_of_particles(n);
    for (Vec3& v : state.particles.v) v = Vec3(1, -2, 0.5);
    list.push_back(
        situation(std::to_string(n) + " particles", Expected::goes_on, state, 0x1p-13, steps));
  }
  return list;
}

Situation empty_row() {
  return situation("no particle at all", Expected::goes_on, State{}, 0x1p-13);
}

std::vector<Situation> awkward_places(int steps) {
  State coincident = row_of_particles(8);
  for (Vec3& x : coincident.particles.x) x = coincident.particles.x[0];
  for (Mat3& F : coincident.particles.F_E) F *= 0.99;
  for (Vec3& v : coincident.particles.v) v = Vec3(1, -1, 1);

  State node = row_of_particles(4);
  for (Vec3& v : node.particles.v) v = Vec3(1, 0, -1);
  node.particles.x[0] = row_spacing * Vec3(2, -3, 0);
  node.particles.x[1] = row_spacing * Vec3(2, -3, std::nextafter(0.0, -1.0));

  Situation seam = situation("on the seam of a periodic domain of 4 cells", Expected::goes_on,
                             row_of_particles(4), 0x1p-9, steps);
  seam.scene.grid.periodic = row_spacing * Vec3(4, 4, 4);
  Particles& p = seam.state.particles;
  for (Vec3& x : p.x) x = seam.scene.wrap(x);
  p.x[0].setZero();
  p.x[1] = row_spacing * Vec3(4 - 0x1p-20, 4 - 0x1p-20, 0);
  for (Vec3& v : p.v) v = Vec3(3, 3, -3);

  return {situation("coincident particles", Expected::goes_on, coincident, 0x1p-13, steps),
          situation("on a node, and beside it by the smallest number", Expected::goes_on, node,
                    0x1p-13, steps),
          seam};
}

std::vector<Situation> far_in_one_step(int steps) {
  State fast = row_of_particles(6);
  for (std::size_t q = 0; q < 6; ++q) fast.particles.v[q] = Vec3(q % 2 == 0 ? 50 : -50, 20, 0);
  // v = −x/Δt: the cloud collapses into a point, F̂ = 0.
  State collapse;
  for (int i = 0; i < 64; ++i) {
    State one = row_of_particles(1);
    one.particles.x[0] = row_spacing * (Vec3(i / 16, i / 4 % 4, i % 4) / 2 - Vec3::Constant(0.75));
    one.particles.v[0] = -one.particles.x[0] / 0x1p-10;
    one.particles.id[0] = i;
    collapse.particles.append(one.particles);
  }
  return {situation("v_p Δt > h", Expected::goes_on, fast, 0x1p-9, steps),
          situation("Δt ∇v = −I", Expected::either, collapse, 0x1p-10, 3)};
}

std::vector<Situation> no_deformations() {
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
  std::vector<Situation> situations;
  for (const auto& one : list) {
    State state = row_of_particles(6);
    state.particles.F_E[2] = one.F;
    situations.push_back(situation(one.name, Expected::either, state, 0x1p-16, 3));
  }
  return situations;
}

Situation hardening_overflow(Precision precision) {
  // e^{ξ(1−J_P)} is beyond the largest number: J_P < −69.9 in double, −7.8 in float at ξ = 10.
  const double J_P = precision == Precision::float32 ? -9 : -75;
  return spoiled("overflow of the hardening", 4, 0x1p-14, [=](Particles& p, std::size_t at) {
    for (Mat3& F : p.F_E) F *= 0.995;
    p.F_P[at] = Vec3(1, 1, J_P).asDiagonal();
  });
}

std::vector<Situation> outside_the_domain(Precision precision) {
  const bool single = precision == Precision::float32;
  return {
      spoiled("a particle leaves the domain", 3, 0x1p-10,
              [=](Particles& p, std::size_t at) {
                p.x[at][0] += 20 * row_spacing;  // alone: what it does to others is no fault
                p.v[at] = Vec3(0, single ? 1e30 : 1e200, 0);
              }),
      spoiled("a particle is outside the domain", 5, 0x1p-10,
              [=](Particles& p, std::size_t at) { p.x[at] = Vec3(0, 0, single ? 1e20 : 1e100); })};
}

std::vector<Situation> not_a_number() {
  const struct {
    const char* name;
    void (*set)(Particles&, std::size_t, double);
  } fields[] = {
      {"x_p", [](Particles& p, std::size_t at, double bad) { p.x[at][1] = bad; }},
      {"v_p", [](Particles& p, std::size_t at, double bad) { p.v[at][0] = bad; }},
      {"F_E", [](Particles& p, std::size_t at, double bad) { p.F_E[at](1, 2) = bad; }},
      {"F_P", [](Particles& p, std::size_t at, double bad) { p.F_P[at](0, 0) = bad; }},
      {"m_p", [](Particles& p, std::size_t at, double bad) { p.m[at] = bad; }},
      {"V_p0", [](Particles& p, std::size_t at, double bad) { p.V_0[at] = bad; }},
  };
  std::vector<Situation> list;
  for (const bool infinite : {false, true})
    for (const auto& field : fields)
      list.push_back(spoiled(std::string(infinite ? "infinity in " : "NaN in ") + field.name, 2,
                             0x1p-14, [&](Particles& p, std::size_t at) {
                               field.set(p, at,
                                         infinite ? std::numeric_limits<double>::infinity()
                                                  : std::numeric_limits<double>::quiet_NaN());
                             }));
  list.push_back(
      spoiled("a negative mass", 2, 0x1p-14, [](Particles& p, std::size_t at) { p.m[at] = -1; }));
  return list;
}

}  // namespace firn::studies
