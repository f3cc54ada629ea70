// SPDX-License-Identifier: BSD-3-Clause
#include "verification/support/snow_cases.hpp"

#include <cmath>

namespace firn::fixtures {

namespace {

constexpr double h = 0.05;

Scene snow_scene() {
  Scene scene;
  scene.name = "lump";
  scene.gravity = {0.5, 0, -9.81};
  scene.grid.spacing = h;
  scene.grid.origin = {0.01, -0.02, 0.03};
  scene.time.step = 1e-4;
  scene.time.end = 1;
  scene.time.frames_per_second = 48;
  scene.flip = 0.9;
  Material wet;
  wet.name = "wet";
  wet.youngs_modulus = 2e5;
  wet.poisson_ratio = 0.3;
  wet.density = 300;
  wet.hardening = 7;
  wet.critical_compression = 1.9e-2;
  wet.critical_stretch = 5e-3;
  scene.materials = {Material{}, wet};
  scene.materials[0].name = "dry";
  // Where the scene would have its particles; a guest is given the scene's text.
  Body body;
  body.shape = Box{Vec3::Zero(), Vec3::Constant(h)};
  body.sampling = Sampling::lattice;
  scene.bodies = {body};
  return scene;
}

/// n particles in a cube around the grid's origin; a few have just been made (F_E = I).
State lump(const Scene& scene, std::size_t n, double half_width, std::uint64_t seed) {
  State state = random_snow(scene, n, half_width, seed,
                            {.velocity = Vec3(1, 0.3, -2), .velocity_spread = 0.7, .strain = 0.03});
  Particles& p = state.particles;
  for (std::size_t q = 0; q < n; ++q) {
    p.x[q] = scene.wrap(p.x[q]);
    p.V_0[q] = q % 2 == 0 ? p.m[q] / 390 : 0;
    p.material[q] = q % 3 == 0 ? 1 : 0;
    p.id[q] = static_cast<std::int64_t>(n - q);
    if (q % 16 == 7) p.F_E[q].setIdentity();
  }
  return state;
}

}  // namespace

Case lump_on_slope() {
  Case c{"lump on a slope", snow_scene(), {}};
  Collider slope;
  slope.shape = HalfSpace{{0.0123, 0.0077, -0.0431}, {0.2, 0.1, 1}};
  slope.center = center(slope.shape);
  slope.friction = 0.3;
  slope.velocity = {0.4, -0.2, 0.1};
  Collider wheel;
  wheel.shape = Sphere{{0.12, 0.03, 0.02}, 0.11};
  wheel.center = center(wheel.shape);
  wheel.sticky = true;
  wheel.angular_velocity = {0, 3, 1};
  Collider wall;
  wall.shape = HalfSpace{{-0.0613, 0.02, 0}, {1, 0.2, 0.4}};
  wall.center = {0.3, 0.1, 0};
  wall.friction = 0.6;
  wall.angular_velocity = {0, 0, 0.5};
  c.scene.colliders = {slope, wheel, wall};
  c.state = lump(c.scene, 260, 0.13, 7);
  // Alone, a ten-thousandth of a cell from a node: what it gives two cells away is all there is.
  c.state.particles.x[0] = c.scene.grid.origin + h * Vec3(12.0001, 9.3, -7.6);
  return c;
}

Case implicit_lump() {
  Case c = lump_on_slope();
  c.name = "implicit lump";
  c.scene.time.step = 1e-3;
  c.scene.integrator.type = IntegratorType::semi_implicit;
  c.scene.integrator.implicitness = 0.8;
  c.scene.integrator.tolerance = 1e-6;
  c.state.particles.resize(120);
  return c;
}

Case periodic_lump() {
  Case c{"periodic lump", snow_scene(), {}};
  c.scene.grid.periodic = {6 * h, 0, 0};
  c.scene.time.adaptive = true;
  c.scene.time.max_step = 1e-3;
  c.scene.time.cfl = 0.5;
  c.scene.time.elastic_cfl = 0.3;
  c.state = lump(c.scene, 200, 0.16, 11);
  for (std::size_t q = 0; q < 20; ++q) c.state.particles.F_P[q] *= 0.95;
  // On their way over the seam.
  c.state.particles.x[3][0] = c.scene.grid.origin[0] + 6 * h - 1e-5;
  c.state.particles.x[4][0] = c.scene.grid.origin[0] + 1e-5;
  c.state.particles.v[4][0] = -2;
  return c;
}

Case awkward_lump() {
  Case c = lump_on_slope();
  c.name = "awkward lump";
  // An inverted F_E turns F_P over in the first step, which hardens by e^20: further than one
  // step the method itself does not go.
  c.steps = 1;
  Particles& p = c.state.particles;
  const Vec3 o = c.scene.grid.origin;
  p.x[0] = o + h * Vec3(4, 4, 3);      // on a node
  p.x[1] = o + h * Vec3(4, 4.5, 3.5);  // on a face
  p.x[2] = Vec3(std::nextafter(p.x[1][0], 1), p.x[1][1], p.x[1][2]);
  p.x[3] = Vec3(std::nextafter(p.x[1][0], 0), p.x[1][1], p.x[1][2]);
  p.x[4] = p.x[5];                                     // coincident
  p.x[6] = o + h * Vec3(40.25, -30.5, 25.75);          // alone
  p.x[7] = o + h * Vec3(40.25 + 3.999, -30.5, 25.75);  // within reach by a thousandth of h
  p.m[8] *= 1e-4;
  p.V_0[8] *= 1e-4;
  p.m[9] *= 1e3;
  p.F_E[10] = -Mat3::Identity();
  p.F_E[11] = Vec3(1, 1, -0.99).asDiagonal();
  p.F_E[12] = Vec3(1, 0.5, 1e-3).asDiagonal();
  p.F_E[13] << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  p.F_E[14] = Vec3(0.5, 0.6, 0.7).asDiagonal();
  p.F_E[15] = Vec3(1.5, 1.2, 1.4).asDiagonal();
  p.F_E[16] = Mat3::Identity();
  p.F_P[17] *= 0.85;
  p.F_P[18] *= 1.3;
  p.v[19].setZero();
  return c;
}

Case far_lump() {
  Case c = lump_on_slope();
  c.name = "far lump";
  const Vec3 away = 20000 * h * Vec3(1, -1, 0.5);
  c.scene.grid.origin += away;
  for (Vec3& x : c.state.particles.x) x += away;
  for (Collider& collider : c.scene.colliders) {
    if (auto* plane = std::get_if<HalfSpace>(&collider.shape)) plane->point += away;
    if (auto* sphere = std::get_if<Sphere>(&collider.shape)) sphere->center += away;
    collider.center += away;
  }
  return c;
}

std::vector<Case> snow_cases() {
  return {lump_on_slope(), periodic_lump(), awkward_lump(), implicit_lump()};
}

}  // namespace firn::fixtures
