// SPDX-License-Identifier: BSD-3-Clause
#include "verification/support/snow.hpp"

#include <Eigen/LU>
#include <Eigen/QR>

namespace firn::fixtures {

Mat3 random_rotation(Random& random) {
  const Mat3 Q = Eigen::HouseholderQR<Mat3>(random.mat3()).householderQ();
  return Q.determinant() < 0 ? Mat3(-Q) : Q;
}

void random_particle(Random& random, double h, Particles& p, std::size_t i, const Snow& snow) {
  p.v[i] = snow.velocity + snow.velocity_spread * random.vec3();
  p.m[i] = 400 * h * h * h / 8 * (1 + 0.5 * random());
  p.V_0[i] = h * h * h / 8;
  p.F_E[i] = Mat3::Identity() + snow.strain * random.mat3();
  p.F_P[i] = Mat3::Identity() + snow.plastic_strain * random.mat3();
  p.id[i] = static_cast<std::int64_t>(i);
}

State random_snow(const Scene& scene, std::size_t n, double half_width, std::uint64_t seed,
                  const Snow& snow) {
  Random random(seed);
  State state;
  Particles& p = state.particles;
  p.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    p.x[i] = scene.grid.origin + half_width * random.vec3();
    random_particle(random, scene.grid.spacing, p, i, snow);
  }
  return state;
}

}  // namespace firn::fixtures
