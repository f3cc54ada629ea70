// SPDX-License-Identifier: BSD-3-Clause
#include "verification/suite/copies.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace firn::suite {

Scene lump_scene() {
  Scene scene = plain_scene();
  scene.flip = 0.95;
  scene.materials = {Material{}};
  scene.materials[0].name = "snow";
  return scene;
}

State small_lump(std::size_t n, int cells, int bits, std::uint64_t seed) {
  State lump = rounded_snow(n, cells, seed);
  Particles& p = lump.particles;
  const double unit = std::ldexp(spacing, -bits);
  // Not on the last node of the cube, which would reach one node further.
  const double last = 0.5 * cells * spacing - std::ldexp(spacing, -std::max(bits, 1));
  for (std::size_t q = 0; q < n; ++q) {
    for (int a = 0; a < 3; ++a)
      p.x[q][a] = std::min(unit * std::floor(p.x[q][a] / unit), unit * std::floor(last / unit));
    p.V_0[q] = q % 2 == 0 ? 0 : p.V_0[q];
  }
  p.x[0] = Vec3::Constant(-0.5 * cells * spacing);
  p.x[1] = Vec3::Constant(unit * std::floor(last / unit));
  return lump;
}

State copies_of(const State& lump, const std::vector<Vec3>& places) {
  const std::size_t copies = places.size();
  State all;
  const Particles& from = lump.particles;
  Particles& to = all.particles;
  to.resize(from.size() * copies);
  for (std::size_t q = 0; q < from.size(); ++q)
    for (std::size_t c = 0; c < copies; ++c) {
      const std::size_t p = q * copies + c;
      to.x[p] = from.x[q] + spacing * places[c];
      to.v[p] = from.v[q];
      to.m[p] = from.m[q];
      to.V_0[p] = from.V_0[q];
      to.F_E[p] = from.F_E[q];
      to.F_P[p] = from.F_P[q];
      to.material[p] = from.material[q];
      to.id[p] = static_cast<std::int64_t>(p);
    }
  return all;
}

namespace {

/// How much two runs of one lump may differ: roundoff, because the sums of a node may be taken
/// in another order.
struct Bounds {
  double v = 0, F = 0;
  Bounds(const Scene& scene, const Particles& before, const Particles& after, int steps,
         double dt) {
    double speed = 0, stress = 0, light = 0, size = 0;
    for (std::size_t q = 0; q < before.size(); ++q) {
      speed = std::max({speed, before.v[q].norm(), after.v[q].norm()});
      stress = std::max(stress, stress_roundoff(scene.materials[0], before.F_E[q], before.F_P[q]));
      light = std::max(light, after.V_0[q] / before.m[q]);
      size = std::max({size, after.F_E[q].norm(), after.F_P[q].norm()});
    }
    // v_p is a sum of 64 products, three times: v_i, v_PIC and the FLIP increment. Forces add
    // Δt V/m Σ|∇w| δτ, Σ|∇w| ≤ 3/h, of the particle itself and of a few around it.
    const double of_stress = 8 * 3 / spacing * dt * light * stress;
    v = steps * (3 * 64 * eps() * 2 * speed + of_stress);
    // F' = (I + Δt ∇v) F and its decomposition, some 64 roundings.
    F = steps * (64 * eps() * size + 3 / spacing * dt * v) * size;
  }
};

}  // namespace

CopyError compare_copies(const Scene& scene, const State& lump, const State& alone,
                         const std::vector<Vec3>& places, const Particles& copies, int steps,
                         double dt) {
  const Particles& one = alone.particles;
  const Bounds bounds(scene, lump.particles, one, steps, dt);
  CopyError worst;
  if (copies.size() != one.size() * places.size()) return {2, 1, "particles are missing"};
  for (std::size_t p = 0; p < copies.size(); ++p) {
    const std::size_t q = p / places.size();
    const Vec3& place = places[p % places.size()];
    const auto judge = [&](const char* field, double error, double bound, int numbers) {
      worst.numbers += numbers;
      const double ratio = error == 0 ? 0 : error / bound;
      if (ratio <= worst.in_bounds) return;
      worst.in_bounds = std::isnan(ratio) ? HUGE_VAL : ratio;
      worst.where = fmt::format("{} of particle {}, at ({}, {}, {}) cells: {:.3g} off", field, p,
                                place[0], place[1], place[2], error);
    };
    const Vec3 x = one.x[q] + spacing * place;
    judge("v_p", (copies.v[p] - one.v[q]).norm(), bounds.v, 3);
    // The far end of the sum is not the lump's: a rounding of each step's position there.
    judge("x_p", (copies.x[p] - x).norm(),
          steps * (4 * eps() * (x.norm() + 4 * spacing) + dt * bounds.v), 3);
    judge("F_E", (copies.F_E[p] - one.F_E[q]).norm(), bounds.F, 9);
    judge("F_P", (copies.F_P[p] - one.F_P[q]).norm(), bounds.F, 9);
    // m_p h³/Σ m_i w_ip: two sums of 64 positive terms.
    judge("V_p0", std::abs(copies.V_0[p] - one.V_0[q]), 2 * 64 * eps() * one.V_0[q], 1);
  }
  return worst;
}

}  // namespace firn::suite
