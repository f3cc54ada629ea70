// SPDX-License-Identifier: BSD-3-Clause
#include "bench/landing_block.hpp"

#include <cmath>

namespace firn::bench {

Scene landing_block(double youngs_modulus, double cells, std::uint64_t seed) {
  constexpr double h = 0.025, impact_speed = 1.5;
  Scene scene;
  scene.name = "landing block";
  scene.gravity = Vec3(0, 0, -9.81);
  scene.grid.spacing = h;
  Material snow;
  snow.youngs_modulus = youngs_modulus;
  scene.materials.push_back(snow);
  const double c = std::sqrt((snow.lambda_0() + 2 * snow.mu_0()) / snow.density);
  scene.time.step = 0.5 * h / c;
  scene.time.end = 1;
  scene.time.frames_per_second = 1;
  Body body;
  const double half = 0.5 * cells * h;
  body.shape = Box{Vec3(-half, -half, 0.3 * h), Vec3(half, half, 2 * half + 0.3 * h)};
  body.seed = seed;
  body.velocity = Vec3(0.5, 0, -impact_speed);
  body.volumes = VolumeSource::exact;
  scene.bodies.push_back(body);
  Collider floor;
  floor.shape = HalfSpace{Vec3(0, 0, 0.15 * h), Vec3(0, 0, 1)};
  floor.friction = 0.3;
  scene.colliders.push_back(floor);
  return scene;
}

Scene in_large_steps(Scene scene, double factor, double tolerance) {
  scene.integrator = {IntegratorType::semi_implicit, 1.0, tolerance, 100'000};
  scene.time.step *= factor;
  return scene;
}

}  // namespace firn::bench
