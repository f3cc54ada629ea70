// SPDX-License-Identifier: BSD-3-Clause
/// What linear theory says about the largest stable step.

#include <algorithm>
#include <cmath>

#include "firn/scene.hpp"
#include "verification/studies/stability.hpp"

namespace firn::studies {

namespace {

/// N and N' of the cubic B-spline (Stomakhin et al. 2013, §4).
struct Spline {
  double N, slope;
};
Spline spline(double x) {
  const double d = std::abs(x), sign = x < 0 ? -1 : 1;
  if (d < 1) return {0.5 * d * d * d - d * d + 2.0 / 3, sign * (1.5 * d - 2) * d};
  return d < 2 ? Spline{std::pow(2 - d, 3) / 6, -sign * 0.5 * (2 - d) * (2 - d)} : Spline{0, 0};
}

/// A lone particle, one axis like the others: its nodes' masses are m_i = w_i m, and one step
/// multiplies an isotropic strain by 1 − z², z² = Δt² (V/m)(2μ+3λ) S/h², S = ΣN'²/N of one
/// axis; at most `growth` while z² ≤ 1 + growth. The estimate of step 2 is V = m/Σ_i(m_i w_i/h³) =
/// h³/(ΣN²)³: 8 h³ on a node, 10.3 h³ in the middle of a cell, whatever the particle's share of a
/// cell.
double lone_cfl(const StabilityPoint& point, double growth) {
  double S = 0, squares = 0;
  for (int node = -1; node <= 2; ++node) {
    const Spline at = spline(point.place - node);
    squares += at.N * at.N;
    if (at.N > 0) S += at.slope * at.slope / at.N;
  }
  const double share = 1.0 / std::pow(point.per_edge, 3);                    // m/(ρ h³)
  const double volume = point.estimated ? 1 / std::pow(squares, 3) : share;  // V/h³
  Material m;
  const double modulus = m.lambda_0() + 2 * m.mu_0();
  return std::sqrt((1 + growth) * modulus * share /
                   (volume * S * (2 * m.mu_0() + 3 * m.lambda_0())));
}

}  // namespace

double StabilityPoint::sound_speed() const {
  Material m;
  m.youngs_modulus = E;
  return std::sqrt(std::exp(hardening * (1 - J_P)) * (m.lambda_0() + 2 * m.mu_0()) / m.density);
}

WaveRecurrence wave_recurrence(double alpha, double beta, double kh, double cfl) {
  const double half = 0.5 * kh, N = std::pow(std::sin(half) / half, 4), N2 = N * N;
  const double z2 = std::pow(kh * N * cfl, 2), b1 = 1 + beta * z2;
  return {alpha * (1 - N2) * (1 - z2 / b1) + N2 / b1, alpha * (1 - N2) + N2 / b1 + 1 - z2 / b1};
}

double predicted_cfl(const StabilityPoint& point, double growth) {
  if (point.lone) return lone_cfl(point, growth);
  double limit = largest_tried;
  for (double kh = 0.5; kh < 3.1; kh += 0.005) {
    double low = 0, high = 1.01 * largest_tried;
    for (int i = 0; i < 50; ++i) {
      const double cfl = 0.5 * (low + high);
      const WaveRecurrence wave = wave_recurrence(point.alpha, point.beta, kh, cfl);
      const double det = wave.det / (growth * growth), tr = wave.tr / growth;
      // Jury's conditions for |a| ≤ growth at both roots; det = 1 at α = 1 is marginal by design.
      const bool stable = std::abs(det) <= 1 + 1e-12 && std::abs(tr) <= 1 + det + 1e-12;
      (stable ? low : high) = cfl;
    }
    limit = std::min(limit, low);
  }
  return limit;
}

}  // namespace firn::studies
