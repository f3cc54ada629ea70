// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plain_hessian.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace firn::bench {

namespace {

/// N and N' at the four nodes around an offset t in a cell; outer branch factored.
void weigh(double t, double N[4], double dN[4]) {
  const double o = 1 - t;
  N[0] = o * o * o / 6, N[3] = t * t * t / 6;
  N[1] = 2.0 / 3 - t * t + t * t * t / 2, N[2] = 2.0 / 3 - o * o + o * o * o / 2;
  dN[0] = -o * o / 2, dN[3] = t * t / 2;
  dN[1] = (1.5 * t - 2) * t, dN[2] = (2 - 1.5 * o) * o;
}

}  // namespace

PlainHessian::PlainHessian(const Scene& scene, const Particles& particles)
    : inverse_spacing_(1 / scene.grid.spacing) {
  const Material& material = scene.materials.front();
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (const Vec3& x : particles.x) {
    const Vec3 at = (x - scene.grid.origin) * inverse_spacing_;
    low = low.cwiseMin(at), high = high.cwiseMax(at);
  }
  for (int a = 0; a < 3; ++a) {
    first_[a] = static_cast<int>(std::floor(low[a])) - 1;
    size_[a] = static_cast<int>(std::floor(high[a])) + 3 - first_[a];
  }
  for (std::size_t p = 0; p < particles.size(); ++p) {
    Particle q;
    for (int a = 0; a < 3; ++a)
      q.x[a] = (particles.x[p][a] - scene.grid.origin[a]) * inverse_spacing_ - first_[a];
    const Mat3& F = particles.F_E[p];
    q.stretch = Eigen::SelfAdjointEigenSolver<Mat3>(F * F.transpose()).operatorSqrt();
    q.K_inverse = (q.stretch.trace() * Mat3::Identity() - q.stretch).inverse();
    const double J = F.determinant(), V_0 = particles.V_0[p];
    const double hard = std::exp(material.hardening * (1 - particles.F_P[p].determinant()));
    q.shear = 2 * material.mu_0() * hard * V_0;
    q.transposed = material.lambda_0() * hard * V_0 * (J - 1) * J;
    q.volume = material.lambda_0() * hard * V_0 * J * J + q.transposed;
    particles_.push_back(q);
  }
}

std::size_t PlainHessian::nodes() const {
  return static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
         static_cast<std::size_t>(size_[2]);
}

std::size_t PlainHessian::place(const NodeIndex& i) const {
  return static_cast<std::size_t>(((i.i - first_[0]) * size_[1] + i.j - first_[1]) * size_[2] +
                                  i.k - first_[2]);
}

void PlainHessian::apply(const std::vector<Vec3>& u, std::vector<Vec3>& Hu) const {
  Hu.assign(nodes(), Vec3::Zero());
  for (const Particle& q : particles_) {
    int cell[3];
    double N[3][4], dN[3][4];
    for (int a = 0; a < 3; ++a) {
      cell[a] = static_cast<int>(q.x[a]);
      weigh(q.x[a] - cell[a], N[a], dN[a]);
      for (double& d : dN[a]) d *= inverse_spacing_;
    }
    const auto for_each_node = [&](const auto& visit) {
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
          const double dNN = dN[0][a] * N[1][b], NdN = N[0][a] * dN[1][b], NN = N[0][a] * N[1][b];
          const int row = ((cell[0] - 1 + a) * size_[1] + cell[1] - 1 + b) * size_[2] + cell[2] - 1;
          for (int c = 0; c < 4; ++c)
            visit(static_cast<std::size_t>(row + c),
                  Vec3(dNN * N[2][c], NdN * N[2][c], NN * dN[2][c]));
        }
    };
    Mat3 L = Mat3::Zero();
    for_each_node([&](std::size_t i, const Vec3& grad_w) { L += u[i] * grad_w.transpose(); });
    Mat3 M = L * q.stretch;
    const Vec3 omega = q.K_inverse * Vec3(M(2, 1) - M(1, 2), M(0, 2) - M(2, 0), M(1, 0) - M(0, 1));
    M(0, 1) += omega[2], M(1, 0) -= omega[2];  // M − [ω]×
    M(0, 2) -= omega[1], M(2, 0) += omega[1];
    M(1, 2) += omega[0], M(2, 1) -= omega[0];
    const Mat3 A = q.shear * M * q.stretch + q.volume * L.trace() * Mat3::Identity() -
                   q.transposed * L.transpose();
    for_each_node([&](std::size_t i, const Vec3& grad_w) { Hu[i] += A * grad_w; });
  }
}

}  // namespace firn::bench
