// SPDX-License-Identifier: BSD-3-Clause
#include "bench/workload.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "verification/support/random.hpp"

namespace firn::bench {

namespace {

constexpr double h = 0.05, dt = 1e-6, drift_per_step = 0.01 * h;

using fixtures::Random;

/// Uniformly distributed rotation (Shoemake 1992).
Mat3 random_rotation(Random& random) {
  const double a = random.uniform(), b = 2 * M_PI * random.uniform(),
               c = 2 * M_PI * random.uniform();
  const double s = std::sqrt(1 - a), r = std::sqrt(a);
  return Eigen::Quaterniond(r * std::cos(c), s * std::sin(b), s * std::cos(b), r * std::sin(c))
      .toRotationMatrix();
}

Scene block_scene() {
  Scene scene;
  scene.name = "benchmark block";
  scene.grid.spacing = h;
  scene.time.end = 1;
  scene.time.step = dt;
  scene.time.frames_per_second = 1;
  scene.flip = 0.95;
  scene.materials.push_back(Material{});
  scene.materials.back().name = "snow";
  return scene;
}

}  // namespace

std::string name(Deformation deformation) {
  return deformation == Deformation::elastic ? "elastic" : "plastic";
}

Workload block(std::size_t particles, Deformation deformation, std::uint64_t seed) {
  Workload work;
  work.scene = block_scene();
  const Material& snow = work.scene.materials.front();
  const bool elastic = deformation == Deformation::elastic;
  const double share = elastic ? 0.5 : 1.0;
  const Vec3 stretch(1 + share * snow.critical_stretch, 1 - share * snow.critical_compression,
                     1 - share * snow.critical_compression);
  const double rate = (elastic ? 1e-6 : 5e-4) / dt;
  work.steps_allowed = elastic ? 1000 : 120;

  const auto edge =
      static_cast<int>(std::lround(std::cbrt(static_cast<double>(particles) / 8) * 2));
  const Vec3 middle = Vec3::Constant(0.25 * h * edge);
  Random random(seed);
  Particles& p = work.state.particles;
  p.resize(static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge) *
           static_cast<std::size_t>(edge));
  std::size_t at = 0;
  for (int i = 0; i < edge; ++i)
    for (int j = 0; j < edge; ++j)
      for (int k = 0; k < edge; ++k, ++at) {
        const double jitter_x = random.uniform(), jitter_y = random.uniform(),
                     jitter_z = random.uniform();
        p.x[at] = 0.5 * h * Vec3(i + jitter_x, j + jitter_y, k + jitter_z);
        const Vec3 from_middle = p.x[at] - middle;
        p.v[at] = Vec3::Constant(drift_per_step / dt) +
                  rate * from_middle.cwiseProduct(Vec3(1, -0.5, -0.5));
        p.m[at] = snow.density * h * h * h / 8;
        p.V_0[at] = h * h * h / 8;
        p.F_E[at] = stretch.asDiagonal() * random_rotation(random);
        p.id[at] = static_cast<std::int64_t>(at);
      }
  return work;
}

}  // namespace firn::bench
