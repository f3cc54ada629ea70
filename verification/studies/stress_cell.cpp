// SPDX-License-Identifier: BSD-3-Clause
/// Situations of lone particles and of one cell of snow.

#include <limits>

#include "verification/studies/stress_list.hpp"
#include "verification/support/scenes.hpp"

namespace firn::studies {

namespace {

constexpr double h = 0.05, nan = std::numeric_limits<double>::quiet_NaN();

struct Change {
  const char* name;
  Expected expected;
  void (*change)(Scene&, Particles&);
};

/// One particle in the middle of a cell, at rest, of an eighth of the cell's volume.
void add(Particles& p, const Vec3& x, const Vec3& v = Vec3::Zero()) {
  Particles one;
  one.resize(1);
  one.x[0] = x;
  one.v[0] = v;
  one.V_0[0] = h * h * h / 8;
  one.m[0] = 400 * one.V_0[0];
  one.id[0] = static_cast<std::int64_t>(p.size());
  p.append(one);
}

/// 2×2×2 particles of one cell, the particle in question first.
void fill_cell(Particles& p) {
  for (int i = 0; i < 8; ++i)
    add(p, h * Vec3(0.25 + 0.5 * (i & 1), 0.25 + 0.25 * (i & 2), 0.25 + 0.125 * (i & 4)));
}

constexpr Change changes[] = {
    {"no particle", Expected::goes_on, [](Scene&, Particles&) {}},
    {"a lone particle", Expected::goes_on,
     [](Scene&, Particles& p) { add(p, h * Vec3(0.3, 0.4, 0.6), Vec3(1, 2, 3)); }},
    {"two particles, 10 h apart", Expected::goes_on,
     [](Scene&, Particles& p) {
       add(p, h * Vec3(0.3, 0.4, 0.6), Vec3(1, 0, 0));
       add(p, h * Vec3(10.3, 0.4, 0.6), Vec3(-1, 0, 0));
     }},
    {"100 particles in one place", Expected::goes_on,
     [](Scene&, Particles& p) {
       for (int i = 0; i < 100; ++i) add(p, h * Vec3(0.3, 0.4, 0.6), Vec3(0, 0, i % 2 ? 1 : -1));
     }},
    {"a particle on a node", Expected::goes_on,
     [](Scene&, Particles& p) { add(p, h * Vec3(2, -1, 0), Vec3(1, 1, 1)); }},
    {"on the face of the periodic domain", Expected::goes_on,
     [](Scene& scene, Particles& p) {
       scene.grid.periodic = Vec3::Constant(8 * h);
       add(p, Vec3::Zero(), Vec3(-1, 0, 0));
       add(p, h * Vec3(7.999999999, 4, 4), Vec3(1, 0, 0));
     }},
    {"faster than a cell per step", Expected::goes_on,
     [](Scene&, Particles& p) {
       fill_cell(p);
       for (Vec3& v : p.v) v = Vec3(3.3 * h / 1e-4, 0, 0);
     }},
    {"leaves the representable domain", Expected::stops,
     [](Scene&, Particles& p) { add(p, h * Vec3(0.3, 0.4, 0.6), Vec3(h * 0x1p30 / 1e-4, 0, 0)); }},
    {"Δt ∇v = −I", Expected::goes_on,
     [](Scene& scene, Particles& p) {
       fill_cell(p);
       for (std::size_t at = 0; at < p.size(); ++at)
         p.v[at] = -(p.x[at] - Vec3::Constant(0.5 * h)) / scene.time.step;
     }},
    {"det F_E < 0, elastic", Expected::goes_on,
     [](Scene& scene, Particles& p) {
       fill_cell(p);
       Material& m = scene.materials.back();
       m.hardening = 0;
       m.critical_compression = m.critical_stretch = std::numeric_limits<double>::infinity();
       p.F_E[0] = Vec3(1, 1, -1).asDiagonal();
     }},
    // The return mapping moves σ_3 from −1 to 1 − θ_c; J_P < −1 stiffens by e²⁰, and bursts.
    {"det F_E < 0, plastic", Expected::stops,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.F_E[0] = Vec3(1, 1, -1).asDiagonal();
     }},
    {"F_E of rank 2", Expected::goes_on,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.F_E[0] = Vec3(1, 1, 0).asDiagonal();
     }},
    {"F_E = 0", Expected::goes_on,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.F_E[0].setZero();
     }},
    {"stiffness overflows: ξ(1 − J_P) = 730", Expected::stops,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.F_E[0] = 1.001 * Mat3::Identity();
       p.F_P[0] = Vec3(1, 1, -72).asDiagonal();
     }},
    {"a velocity is not a number", Expected::stops,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.v[3].y() = nan;
     }},
    {"a position is not a number", Expected::stops,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.x[3].y() = nan;
     }},
    {"F_E is not a number", Expected::stops,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.F_E[3](1, 2) = nan;
     }},
    {"F_P is infinite", Expected::stops,
     [](Scene&, Particles& p) {
       fill_cell(p);
       p.F_P[3](0, 0) = std::numeric_limits<double>::infinity();
     }},
};

}  // namespace

std::vector<Situation> cell_situations() {
  std::vector<Situation> list;
  for (const Change& change : changes) {
    Situation s{.name = change.name, .expected = change.expected, .dt = 1e-4, .steps = 20};
    s.scene = fixtures::elastic_scene("stress", h, s.dt);
    s.scene.materials = {Material{}};
    s.scene.materials.back().name = "snow";
    change.change(s.scene, s.state.particles);
    list.push_back(s);
  }
  return list;
}

}  // namespace firn::studies
