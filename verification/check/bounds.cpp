// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/bounds.hpp"

#include <algorithm>

namespace firn::check {

BoundModel::BoundModel(const Scene& scene, Precision precision)
    : scene_(scene), r_(check::roundoff(precision)) {}

Vec3 position_scale(const Scene& scene, const Vec3& x) {
  return x.cwiseAbs()
      .cwiseMax((x - scene.grid.origin).cwiseAbs())
      .cwiseMax(Vec3::Constant(4 * scene.grid.spacing));
}

/// Every number is rounded to the subject's precision on the way in and may be
/// held in another form there (Δt v/h), whose conversion back costs one more rounding: one
/// eps of its size together. A solver may keep F as F − I, which is the larger of the two
/// where F is small: the eps is of either. Positions have a longer way, to
/// (x − o)/h − block and back: three roundings in each direction and the wrap along a
/// periodic axis, of which the model's 2 eps hold four at their worst.
void BoundModel::load(const State& state) {
  const Particles& p = state.particles;
  const Grid& grid = state.grid;
  const double eps = r_.eps;
  const auto norms = [&](const auto& values, std::vector<double>& out, double floor) {
    out.clear();
    out.reserve(values.size());
    for (const auto& value : values) out.push_back(eps * value.norm() + floor);
  };
  bounds_.x.clear();
  for (const Vec3& x : p.x)
    bounds_.x.push_back(Roundoff::position * eps * position_scale(scene_, x));
  norms(p.v, bounds_.v, 0);
  const auto deformations = [&](const std::vector<Mat3>& values, std::vector<double>& out) {
    out.clear();
    out.reserve(values.size());
    for (const Mat3& F : values)
      out.push_back(eps * std::max(F.norm(), (F - Mat3::Identity()).norm()));
  };
  deformations(p.F_E, bounds_.F_E);
  deformations(p.F_P, bounds_.F_P);
  bounds_.V_0.clear();
  for (const double V : p.V_0) bounds_.V_0.push_back(eps * V);
  bounds_.m_i.clear();
  for (const double m : grid.m) bounds_.m_i.push_back(eps * m + r_.tiny);
  norms(grid.v, bounds_.v_i, 0);
  norms(grid.f, bounds_.f, r_.tiny);
  norms(grid.v_star, bounds_.v_star, 0);
  norms(grid.free_directions, bounds_.free_directions, 0);
  norms(grid.v_new, bounds_.v_new, 0);
  bounds_.node_cause.assign(grid.size(), {});
  bounds_.particle_cause.assign(p.size(), {});
  doubtful_.clear();
  bounds_.node_cause.assign(grid.size(), {});
  bounds_.particle_cause.assign(p.size(), {});
  doubtful_.clear();
}

void BoundModel::advance(Stage stage, const State& before, const State& after, double dt,
                         bool indefinite) {
  switch (stage) {
    case Stage::rasterize: rasterize(before, after); break;
    case Stage::volumes: volumes(before, after); break;
    case Stage::grid_forces: grid_forces(before, after); break;
    case Stage::grid_velocities: grid_velocities(before, after, dt); break;
    case Stage::grid_collisions: grid_collisions(before, after); break;
    case Stage::integration: integration(before, after, dt, indefinite); break;
    case Stage::deformation: deformation(before, dt); break;
    case Stage::particle_velocities: particle_velocities(before); break;
    case Stage::particle_collisions: particle_collisions(before); break;
    case Stage::positions: positions(before, after, dt); break;
  }
}

}  // namespace firn::check
