// SPDX-License-Identifier: BSD-3-Clause
#include "verification/tests/optimized/snow_scenes.hpp"

#include <cstring>

#include "optimized/optimized_solver.hpp"

namespace firn::test {

namespace {

Scene base(double h, double dt) {
  Scene scene;
  scene.name = "test";
  scene.grid.spacing = h;
  scene.time.step = dt;
  scene.time.end = 1;
  scene.time.frames_per_second = 1;
  scene.gravity = Vec3(0.3, -0.2, -9.81);
  return scene;
}

Material snow(double E, double hardening) {
  Material m;
  m.name = "snow";
  m.youngs_modulus = E;
  m.hardening = hardening;
  return m;
}

Body ball(const Vec3& center, double radius, const Vec3& velocity, int material) {
  Body body;
  body.material = material;
  body.shape = Sphere{center, radius};
  body.seed = 3;
  body.velocity = velocity;
  body.angular_velocity = Vec3(3, -2, 1);
  return body;
}

template <class V>
bool equal(const std::vector<V>& a, const std::vector<V>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(V)) == 0);
}

}  // namespace

Scene collision_of_everything() {
  Scene scene = base(0.05, 1e-4);
  scene.materials = {snow(1.4e5, 10), snow(5e4, 5)};
  scene.materials[1].critical_compression = 0.01;
  scene.materials[1].critical_stretch = 0.002;
  scene.bodies = {ball(Vec3(-0.19, 0.02, 0.25), 0.18, Vec3(8, 0, -4), 0),
                  ball(Vec3(0.19, -0.03, 0.27), 0.17, Vec3(-8, 1, -3), 1)};
  scene.bodies[1].volumes = VolumeSource::exact;
  Collider floor;
  floor.shape = HalfSpace{Vec3(0, 0, 0.073), Vec3(0, 0, 1)};
  floor.friction = 0.3;
  Collider wall;
  wall.shape = HalfSpace{Vec3(0.331, 0, 0), Vec3(-1, 0, 0)};
  wall.sticky = true;
  Collider roll;
  roll.shape = Cylinder{Vec3(-0.05, 0, 0.11), Vec3(0, 1, 0), 0.1, 1};
  roll.center = Vec3(-0.05, 0, 0.11);
  roll.angular_velocity = Vec3(0, 20, 0);
  roll.velocity = Vec3(0.5, 0, 0);
  roll.friction = 0.8;
  scene.colliders = {floor, wall, roll};
  return scene;
}

Scene periodic_snow(bool multiple_of_four) {
  Scene scene = base(0.1, 2e-4);
  const Vec3 cells = multiple_of_four ? Vec3(4, 8, 12) : Vec3(5, 9, 7);
  scene.grid.origin = Vec3(-0.37, 0.21, 5);
  scene.grid.periodic = 0.1 * cells;
  scene.materials = {snow(1.4e5, 10)};
  Body body;
  body.shape = Box{scene.grid.origin, scene.grid.origin + scene.grid.periodic};
  body.velocity = Vec3(3, -5, 7);
  body.seed = 5;
  scene.bodies = {body};
  Collider ball;  // across no seam; its φ is not periodic
  ball.shape = Sphere{scene.grid.origin + 0.5 * scene.grid.periodic, 0.16};
  scene.colliders = {ball};
  return scene;
}

Scene block_at_rest() {
  Scene scene = base(0.05, 1e-4);
  scene.gravity = Vec3::Zero();
  scene.materials = {snow(1.4e5, 10)};
  Body rest;
  rest.shape = Box{Vec3(0, 0, 0), Vec3(0.6, 0.3, 0.3)};
  rest.seed = 4;
  scene.bodies = {rest, ball(Vec3(-0.19, 0.14, 0.16), 0.15, Vec3(12, 0, -2), 0)};
  scene.bodies[1].angular_velocity = Vec3::Zero();
  Collider wall;
  wall.shape = HalfSpace{Vec3(0, 0, 0.02), Vec3(0, 0, 1)};
  wall.friction = 0;
  wall.velocity = Vec3(1, 2, 0);
  scene.colliders = {wall};
  return scene;
}

State advanced(const Scene& scene, int steps) {
  const std::unique_ptr<Solver> solver = optimized(Precision::float64);
  State state = initial_state(scene);
  solver->load(scene, state);
  for (int n = 0; n < steps; ++n) solver->step(solver->choose_time_step().dt);
  solver->store(state);
  return state;
}

std::unique_ptr<Solver> optimized(Precision precision, int threads) {
  return make_optimized_solver({precision, threads});
}

bool same_bits(const State& a, const State& b) {
  bool same = a.time == b.time && a.step == b.step && a.grid.node == b.grid.node;
  const auto compare = [&](const char*, const auto& of_a, const auto& of_b) {
    same = same && equal(of_a, of_b);
  };
  for_each_field(compare, a.particles, b.particles);
  for_each_field(compare, a.grid, b.grid);
  return same;
}

}  // namespace firn::test
