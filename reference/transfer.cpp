// SPDX-License-Identifier: BSD-3-Clause
#include "reference/transfer.hpp"

namespace firn::reference {

void scatter_mass_and_momentum(const Particles& particles, std::size_t p, const Stencils& stencils,
                               std::vector<double>& m, std::vector<Vec3>& momentum) {
  const double m_p = particles.m[p];
  const Vec3 v_p = particles.v[p];
  stencils.for_each_node(p, [&](std::size_t i, double w_ip) {
    m[i] += m_p * w_ip;
    momentum[i] += m_p * w_ip * v_p;
  });
}

void scatter_divergence(const Mat3& A, std::size_t p, const Stencils& stencils,
                        std::vector<Vec3>& f) {
  stencils.for_each_node_with_gradient(
      p, [&](std::size_t i, double, const Vec3& grad_w_ip) { f[i] += A * grad_w_ip; });
}

Mat3 gather_gradient(const std::vector<Vec3>& v, std::size_t p, const Stencils& stencils) {
  Mat3 grad_v_p = Mat3::Zero();
  stencils.for_each_node_with_gradient(p, [&](std::size_t i, double, const Vec3& grad_w_ip) {
    grad_v_p += v[i] * grad_w_ip.transpose();
  });
  return grad_v_p;
}

void gather_velocity(const Scene& scene, const Grid& grid, std::size_t p, const Stencils& stencils,
                     Particles& particles) {
  const double alpha = scene.flip;
  Vec3 v_PIC = Vec3::Zero();
  Vec3 change = Vec3::Zero();
  stencils.for_each_node(p, [&](std::size_t i, double w_ip) {
    v_PIC += grid.v_new[i] * w_ip;
    change += (grid.v_new[i] - grid.v[i]) * w_ip;
  });
  const Vec3 v_FLIP = particles.v[p] + change;
  particles.v[p] = (1 - alpha) * v_PIC + alpha * v_FLIP;
}

}  // namespace firn::reference
