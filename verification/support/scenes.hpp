// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The small scenes from which tests, suites and studies start.

#include <array>
#include <limits>
#include <string>

#include "firn/scene.hpp"
#include "firn/state.hpp"

namespace firn::fixtures {

/// The paper's stiffness, purely elastic, without hardening.
inline Material elastic_material() {
  Material m;
  m.name = "elastic";
  m.hardening = 0;
  m.critical_compression = m.critical_stretch = std::numeric_limits<double>::infinity();
  return m;
}

/// No gravity, no colliders, one elastic material, no end in sight. States are loaded, not
/// sampled, but a guest is given the scene's text, which must have a body.
inline Scene elastic_scene(const std::string& name, double h, double dt) {
  Scene scene;
  scene.name = name;
  scene.grid.spacing = h;
  scene.time.step = dt;
  scene.time.end = 1e9;
  scene.time.frames_per_second = 1;
  scene.materials = {elastic_material()};
  Body body;
  body.shape = Box{Vec3::Zero(), Vec3::Constant(h)};
  body.sampling = Sampling::lattice;
  scene.bodies = {body};
  return scene;
}

/// h = 0.1, Δt = 1e-4, no gravity, no colliders, the paper's snow.
inline Scene empty_scene() {
  Scene scene;
  scene.grid.spacing = 0.1;
  scene.time.step = 1e-4;
  scene.materials.push_back(Material{});
  return scene;
}

/// The same, semi-implicit, tolerance 1e-12.
inline Scene implicit_scene(double beta = 1) {
  Scene scene = empty_scene();
  scene.integrator = {IntegratorType::semi_implicit, beta, 1e-12, 2000};
  return scene;
}

/// n particles at rest, undeformed, 1 kg each, in the middle of cell (0,0,0).
inline State particles_at_rest(const Scene& scene, std::size_t n = 1) {
  State state;
  state.particles.resize(n);
  for (std::size_t p = 0; p < n; ++p) {
    state.particles.x[p] = Vec3::Constant(0.5 * scene.grid.spacing);
    state.particles.m[p] = 1;
    state.particles.id[p] = static_cast<std::int64_t>(p);
  }
  return state;
}

/// Undeformed particles at rest with the mass and volume of an eighth of a cell of the first
/// material: 2 per cell edge, over `cells` cells from `corner` on.
inline State lattice_block(const Scene& scene, const std::array<int, 3>& cells,
                           const Vec3& corner = Vec3::Zero()) {
  State state;
  Particles& p = state.particles;
  const double h = scene.grid.spacing;
  p.resize(static_cast<std::size_t>(8 * cells[0] * cells[1] * cells[2]));
  std::size_t q = 0;
  for (int i = 0; i < 2 * cells[0]; ++i)
    for (int j = 0; j < 2 * cells[1]; ++j)
      for (int k = 0; k < 2 * cells[2]; ++k, ++q) {
        p.x[q] = corner + 0.5 * h * Vec3(i + 0.5, j + 0.5, k + 0.5);
        p.V_0[q] = h * h * h / 8;
        p.m[q] = scene.materials.front().density * p.V_0[q];
        p.id[q] = static_cast<std::int64_t>(q);
      }
  return state;
}

/// n particles with ids in falling order; no two numbers are equal.
inline Particles odd_particles(int n) {
  Particles p;
  p.resize(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double s = 1.0 / (3 + i);
    p.x[k] = Vec3(s, 0.1 + s, 1 - s);
    p.v[k] = Vec3(-s, 1.0 / (7 + i), 0.3 * i);
    p.m[k] = 0.01 + s;
    p.V_0[k] = i % 3 == 0 ? 0 : s * s;
    for (int c = 0; c < 9; ++c) {
      p.F_E[k](c / 3, c % 3) += 1e-2 / (11 + 9 * i + c);
      p.F_P[k](c / 3, c % 3) -= 1e-2 / (17 + 9 * i + c);
    }
    p.id[k] = n - 1 - i;
    p.material[k] = i % 2;
  }
  return p;
}

/// For the tests of files and runs: fixed Δt = 1 ms, a frame every 4 steps, end after 0.02 s.
inline Scene tiny_scene(int particles = 5) {
  Scene scene;
  scene.name = "tiny";
  scene.gravity = Vec3(0, 0.5, -9.81);
  scene.grid.spacing = 0.1;
  scene.time.end = 0.02;
  scene.time.step = 1e-3;
  scene.time.frames_per_second = 250;
  scene.materials.resize(2);
  Body body;
  body.sampling = Sampling::from_file;
  body.particles = odd_particles(particles);
  scene.bodies.push_back(body);
  scene.toml = "name = \"tiny\"  # ‖v‖\n";
  return scene;
}

/// The same with Δt ≤ 1 ms that shrinks as the particles become faster.
inline Scene adaptive_scene(int particles = 5) {
  Scene scene = tiny_scene(particles);
  scene.time.adaptive = true;
  scene.time.max_step = 1e-3;
  scene.time.cfl = 0.0123;
  scene.toml = "name = \"tiny and adaptive\"\n";
  return scene;
}

}  // namespace firn::fixtures
