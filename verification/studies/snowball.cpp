// SPDX-License-Identifier: BSD-3-Clause
#include "verification/studies/snowball.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace firn::studies {

namespace {

std::array<int, 3> coarse_cell(const Vec3& x) {
  return {static_cast<int>(std::floor(x.x() / 0.1)), static_cast<int>(std::floor(x.y() / 0.1)),
          static_cast<int>(std::floor(x.z() / 0.1))};
}

}  // namespace

Scene snowball(int resolution, std::uint64_t seed) {
  Scene scene;
  scene.name = "snowball over seeds";
  scene.gravity = Vec3(0, 0, -9.81);
  scene.grid.spacing = 0.3 / resolution;
  // A fifth of the elastic limit of the undeformed snow: compacted snow is stiffer.
  Material snow;
  snow.name = "snow";
  const double c = std::sqrt((snow.lambda_0() + 2 * snow.mu_0()) / snow.density);
  scene.time.step = 0.2 * scene.grid.spacing / c;
  scene.time.end = 0.15;
  scene.time.frames_per_second = 1;
  scene.materials.push_back(snow);
  Body ball;
  ball.shape = Sphere{Vec3(0, 0, 0.4), 0.3};
  ball.seed = seed;
  ball.velocity = Vec3(0, 0, -3);
  ball.volumes = VolumeSource::exact;
  scene.bodies.push_back(ball);
  Collider ground;
  ground.shape = HalfSpace{Vec3(0, 0, -1e-3 * scene.grid.spacing), Vec3::UnitZ()};
  ground.friction = 0.3;
  scene.colliders.push_back(ground);
  return scene;
}

SnowballOutcome drop_snowball(const Subject& subject, const Scene& scene) {
  State state = initial_state(scene);
  const auto solver = subject.create();
  solver->load(scene, state);
  SnowballOutcome outcome;
  const int steps = static_cast<int>(std::ceil(scene.time.end / scene.time.step));
  const double undisturbed = -3.0;
  for (int step = 1; step <= steps; ++step) {
    subject.step(*solver, scene.time.step);
    if (outcome.contact > 0 || step % 5 != 0) continue;
    // Contact: the momentum has left the law of free fall by 1 %.
    const Diagnostics d = solver->diagnostics(scene);
    const double t = step * scene.time.step, free = undisturbed - 9.81 * t;
    if (d.momentum.z() / d.mass > free + 0.01 * std::abs(free)) outcome.contact = t;
  }
  solver->store(state);
  const Particles& p = state.particles;
  double mass = 0, low = 1e9, high = -1e9;
  for (std::size_t at = 0; at < p.size(); ++at) {
    mass += p.m[at];
    outcome.mass[coarse_cell(p.x[at])] += p.m[at];
    outcome.center += p.m[at] * p.x[at].z();
    outcome.J_P += p.m[at] * p.F_P[at].determinant();
    low = std::min(low, p.x[at].x());
    high = std::max(high, p.x[at].x());
  }
  outcome.center /= mass;
  outcome.J_P /= mass;
  outcome.width = high - low;
  return outcome;
}

std::vector<double> misplaced(const std::vector<SnowballOutcome>& outcomes) {
  CoarseMass mean;
  double total = 0;
  for (const SnowballOutcome& o : outcomes)
    for (const auto& [cell, m] : o.mass) {
      mean[cell] += m / static_cast<double>(outcomes.size());
      total += m / static_cast<double>(outcomes.size());
    }
  std::vector<double> shares;
  for (const SnowballOutcome& o : outcomes) {
    double off = 0;
    for (const auto& [cell, m] : mean) {
      const auto at = o.mass.find(cell);
      off += std::abs((at == o.mass.end() ? 0 : at->second) - m);
    }
    shares.push_back(0.5 * off / total);
  }
  return shares;
}

}  // namespace firn::studies
