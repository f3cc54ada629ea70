// SPDX-License-Identifier: BSD-3-Clause
#include "firn/diagnostics.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace firn {

namespace {

/// Independent of the solvers on purpose: an oracle for theirs.
/// Ψ(F_E, F_P) = μ‖F_E − R_E‖² + ½λ(J_E − 1)² [J/m³]. The sign of det F_E goes to
/// the smallest singular value, so that R_E is a rotation.
double energy_density(const Material& material, const Mat3& F_E, const Mat3& F_P) {
  Vec3 sigma = Eigen::JacobiSVD<Mat3>(F_E).singularValues();
  const double J_E = F_E.determinant();
  if (J_E < 0) sigma[2] = -sigma[2];
  const double hardening = std::exp(material.hardening * (1 - F_P.determinant()));
  return hardening * (material.mu_0() * (sigma - Vec3::Ones()).squaredNorm() +
                      0.5 * material.lambda_0() * (J_E - 1) * (J_E - 1));
}

}  // namespace

Diagnostics measure(const Scene& scene, const State& state) {
  const Particles& p = state.particles;
  Diagnostics d;
  d.time = state.time;
  d.min_J_E = p.size() > 0 ? std::numeric_limits<double>::infinity() : 0.0;
  d.max_J_E = p.size() > 0 ? -std::numeric_limits<double>::infinity() : 0.0;
  Vec3 first_moment = Vec3::Zero();
  for (std::size_t i = 0; i < p.size(); ++i) {
    d.mass += p.m[i];
    d.momentum += p.m[i] * p.v[i];
    d.angular_momentum += p.m[i] * p.x[i].cross(p.v[i]);
    d.kinetic_energy += 0.5 * p.m[i] * p.v[i].squaredNorm();
    d.elastic_energy +=
        p.V_0[i] * energy_density(scene.materials[static_cast<std::size_t>(p.material[i])],
                                  p.F_E[i], p.F_P[i]);
    first_moment += p.m[i] * p.x[i];
    d.max_speed = std::max(d.max_speed, p.v[i].norm());
    const double J_E = p.F_E[i].determinant();
    d.min_J_E = std::min(d.min_J_E, J_E);
    d.max_J_E = std::max(d.max_J_E, J_E);
  }
  d.gravitational_energy = -scene.gravity.dot(first_moment);
  if (d.mass > 0) d.center_of_mass = first_moment / d.mass;
  return d;
}

}  // namespace firn
