// SPDX-License-Identifier: BSD-3-Clause
/// Singular values and rotations as a solver's own stress and plasticity use them: every family
/// of matrices that finds what random ones do not.

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "verification/oracles/elastic_oracle.hpp"
#include "verification/oracles/svd_families.hpp"
#include "verification/suite/probes.hpp"

namespace firn::suite {
namespace {

/// Matrices of a family as the subject holds them, where their stress is a number of ordinary
/// size; the identity elsewhere.
std::vector<Mat3> sample(const verification::Family& family, std::size_t count,
                         std::uint64_t seed) {
  verification::Random random(seed);
  std::vector<Mat3> result;
  for (std::size_t k = 0; k < count; ++k) {
    const Mat3 F = rounded(to_mat3(family.make(random, in_float())));
    const bool ordinary = F.allFinite() && F.norm() < 100;
    result.push_back(ordinary ? F : Mat3(Mat3::Identity()));
  }
  return result;
}

/// How the rotation amplifies an error of F: 1/(σ2 + σ3). Where det F < 0 and σ2 = −σ3 it is not
/// defined at all, nor is what depends on it.
struct Conditioning {
  verification::Svd usv;
  double gap;  ///< (σ2 + σ3)/σ1
};

Conditioning conditioning(const Mat3& F) {
  const verification::Svd usv = verification::svd_oracle(to_matrix(F));
  const Real gap = usv.sigma[0] > 0 ? (usv.sigma[1] + usv.sigma[2]) / usv.sigma[0] : 0;
  return {usv, static_cast<double>(gap)};
}

constexpr double smallest_gap = 1e-3;

FIRN_TEST(Svd, stress_of_every_family) {
  LoneParticles lone(effort(6, 3), 11);
  std::uint64_t seed = 100;
  const Material& m = lone.scene.materials[0];
  for (const verification::Family& family : verification::svd_families()) {
    // Without a stop after step 3 the stress shows in F F⁻¹, which needs an inverse.
    std::vector<Mat3> F = sample(family, lone.size(), seed++);
    if (!stops_at(Stage::grid_forces))
      for (Mat3& one : F)
        if (std::abs(one.determinant()) < 0.1 || one.norm() > 10) one.setIdentity();
    lone.state.particles.F_E = F;
    const std::vector<Mat3> tau = kirchhoff_stresses(lone);
    double worst = 0;
    std::int64_t compared = 0;
    for (std::size_t p = 0; p < lone.size(); ++p) {
      const Conditioning c = conditioning(F[p]);
      const bool inverted = c.usv.sigma[2] < 0;
      if (inverted && c.gap < smallest_gap) continue;
      const Matrix FF = to_matrix(F[p]),
                   R = verification::multiply(c.usv.U, verification::transpose(c.usv.V));
      Matrix difference;
      for (std::size_t k = 0; k < 9; ++k) difference[k] = FF[k] - R[k];
      const Real J = verification::det(FF);
      Mat3 exact =
          2 * m.mu_0() * to_mat3(verification::multiply(difference, verification::transpose(FF)));
      exact += static_cast<double>(m.lambda_0() * (J - 1) * J) * Mat3::Identity();
      // R Fᵀ, a square root of F Fᵀ, moves as F does, except where inverted.
      const double bound =
          measured_stress_roundoff(m, F[p], Mat3::Identity()) * (inverted ? 1 / c.gap : 1);
      worst = std::max(worst, (tau[p] - exact).norm() / bound);
      compared += 9;
    }
    within_all(fmt::format("stress: {}", family.name), compared, worst);
  }
}

/// Step 7 with nodes at rest: F̂_E = F_E, only the return mapping works.
FIRN_TEST(Svd, return_mapping_of_every_family) {
  FIRN_NEEDS_STOP(Stage::integration);
  FIRN_NEEDS_STOP(Stage::deformation);
  LoneParticles lone(effort(6, 3), 12);
  Material& m = lone.scene.materials[0];
  m.critical_compression = 2.5e-2;
  m.critical_stretch = 7.5e-3;
  const double low = m.smallest_elastic_stretch(), high = m.largest_elastic_stretch();
  State state = before_stage(lone.scene, lone.state, Stage::deformation, 1e-4);
  for (Vec3& v : state.grid.v_new) v.setZero();
  fixtures::Random random(13);
  std::uint64_t seed = 200;
  for (const verification::Family& family : verification::svd_families()) {
    const std::vector<Mat3> F_hat = sample(family, lone.size(), seed++);
    state.particles.F_E = F_hat;
    for (Mat3& F_P : state.particles.F_P)
      F_P = rounded(Mat3(Mat3::Identity() + 0.1 * random.mat3()));
    const State after = run_through(lone.scene, state, Stage::deformation, 1e-4);
    double product = 0, limits = 0, exact = 0, kept = 0;
    std::string where;
    std::int64_t compared = 0, unclamped = 0;
    for (std::size_t p = 0; p < lone.size(); ++p) {
      const Mat3 &F_E = after.particles.F_E[p], &F_P = after.particles.F_P[p];
      const Mat3& F_P_old = state.particles.F_P[p];
      const double size = std::max(F_hat[p].norm(), 1.0);
      // Products of matrices of these sizes, whose factors carry 20 eps each.
      product = std::max(product, (F_E * F_P - F_hat[p] * F_P_old).norm() /
                                      (64 * eps() * size * (F_P_old.norm() + F_P.norm())));
      const verification::Svd result = verification::svd_oracle(to_matrix(F_E));
      for (const Real s : result.sigma) {
        const double beyond = std::max(static_cast<double>(s) - high, low - static_cast<double>(s));
        // F̂ + U(Σ − Σ̂)Vᵀ is as good a formula as U Σ Vᵀ; its roundings are those of F̂.
        if (beyond / (16 * eps() * size) <= limits) continue;
        limits = beyond / (16 * eps() * size);
        const verification::Svd usv = conditioning(F_hat[p]).usv;
        where = fmt::format("F_E with {:.6Lg}, {:.6Lg}, {:.6Lg}", usv.sigma[0], usv.sigma[1],
                            usv.sigma[2]);
      }
      const Conditioning c = conditioning(F_hat[p]);
      const double margin = 16 * eps() * size;
      if (c.usv.sigma[0] < high - margin && c.usv.sigma[2] > low + margin) {
        ++unclamped;
        kept = std::max(
            {kept, (F_E - F_hat[p]).norm() / (8 * eps()), (F_P - F_P_old).norm() / (8 * eps())});
      }
      if (c.gap < smallest_gap) continue;
      const verification::ReturnMapped right =
          verification::return_map_oracle(to_matrix(F_hat[p]), to_matrix(F_P_old), low, high);
      // U and V turn by the error of F over σ_i + σ_j.
      const double amplified = 1 + 2 * size / (c.gap * static_cast<double>(c.usv.sigma[0]));
      exact = std::max(exact, (F_E - to_mat3(right.F_E)).norm() / (64 * eps() * amplified));
      exact = std::max(exact, (F_P - to_mat3(right.F_P)).norm() /
                                  (64 * eps() * amplified * (1 + size) * F_P_old.norm()));
      compared += 18;
    }
    const auto n = static_cast<std::int64_t>(lone.size());
    within_all(fmt::format("F_E F_P = F̂_E F_P: {}", family.name), 9 * n, product);
    within_all(fmt::format("singular values of F_E within limits: {}", family.name), 3 * n, limits,
               where);
    if (compared > 0) within_all(fmt::format("F_E and F_P: {}", family.name), compared, exact);
    if (unclamped > 0)
      within_all(fmt::format("elastic particles untouched: {}", family.name), 18 * unclamped, kept);
  }
}

}  // namespace
}  // namespace firn::suite
