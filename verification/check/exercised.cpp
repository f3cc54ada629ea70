// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/exercised.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "verification/check/conditioning.hpp"
#include "verification/check/contact_kind.hpp"

namespace firn {

namespace {

/// "Light" and "degenerate": ratios at which a wrong code that is right for common numbers shows.
constexpr double light = 1e-6, degenerate = 1e-3;

/// J_P beyond rounding: what a step of ordinary snow changes is larger.
constexpr double plastic_change = 1e-12;

bool uses_several_materials(const Particles& particles) {
  const auto& material = particles.material;
  return std::adjacent_find(material.begin(), material.end(), std::not_equal_to<>()) !=
         material.end();
}

/// First and last node along an axis that a particle at t (in cells) reaches, cubic kernel.
int first_node(double t) { return static_cast<int>(std::floor(t)) - 1; }
int last_node(double t) { return first_node(t) + 3; }

/// Nodes of `grid` in reach of particles of more than one material.
std::int64_t mixed_nodes(const Scene& scene, const Particles& p, const Grid& grid) {
  constexpr std::int32_t none = -1, mixed = -2;
  std::vector<std::int32_t> material(grid.size(), none);
  const auto wrapped = [&](int index, int axis) {
    const int n = scene.grid.period_nodes(axis);
    return n == 0 ? index : ((index % n) + n) % n;
  };
  for (std::size_t q = 0; q < p.size(); ++q) {
    const Vec3 t = (p.x[q] - scene.grid.origin) / scene.grid.spacing;
    for (int i = first_node(t[0]); i <= last_node(t[0]); ++i)
      for (int j = first_node(t[1]); j <= last_node(t[1]); ++j)
        for (int k = first_node(t[2]); k <= last_node(t[2]); ++k) {
          const NodeIndex node{wrapped(i, 0), wrapped(j, 1), wrapped(k, 2)};
          const auto at = std::lower_bound(grid.node.begin(), grid.node.end(), node);
          if (at == grid.node.end() || !(*at == node)) continue;
          auto& known = material[static_cast<std::size_t>(at - grid.node.begin())];
          known = known == none || known == p.material[q] ? p.material[q] : mixed;
        }
  }
  return std::count(material.begin(), material.end(), mixed);
}

}  // namespace

void Exercised::places(const Scene& scene, const State& before, const State& after) {
  const Particles& p = before.particles;
  double heaviest = 0;
  for (std::size_t q = 0; q < p.size(); ++q) {
    heaviest = std::max(heaviest, p.m[q]);
    const Vec3 t = (p.x[q] - scene.grid.origin) / scene.grid.spacing;
    int whole = 0;
    bool seam = false;
    for (int axis = 0; axis < 3; ++axis) {
      if (t[axis] == std::floor(t[axis])) ++whole;
      const int n = scene.grid.period_nodes(axis);
      seam = seam || (n > 0 && (first_node(t[axis]) < 0 || last_node(t[axis]) >= n));
    }
    if (whole > 0) add(whole == 3 ? Feature::on_node : Feature::on_face);
    if (seam) add(Feature::across_seam);
  }
  for (const double m : after.grid.m)
    if (m < light * heaviest) add(Feature::light_node);
  if (uses_several_materials(p)) add(Feature::several_materials, mixed_nodes(scene, p, after.grid));
}

void Exercised::strains(const State& before) {
  const Particles& p = before.particles;
  for (std::size_t q = 0; q < p.size(); ++q) {
    const double J_P = p.F_P[q].determinant(), J_E = p.F_E[q].determinant();
    if (J_P < 1 - plastic_change) add(Feature::compressed);
    if (J_P > 1 + plastic_change) add(Feature::expanded);
    if (J_E <= 0) add(Feature::inverted);
    // |det F| ≤ σ3 σ1², so a larger determinant needs no singular values.
    const double largest = p.F_E[q].norm();
    if (std::abs(J_E) > degenerate * largest * largest * largest) continue;
    const Vec3 sigma = check::signed_singular_values(p.F_E[q]);
    if (std::abs(sigma[2]) < degenerate * sigma[0]) add(Feature::degenerate);
  }
}

int Exercised::contact(const Scene& scene, const Vec3& x, Vec3 v, double time,
                       const std::array<Feature, 3>& kinds) {
  int held = 0;
  for (const Collider& collider : scene.colliders) {
    if (collider.phi(x, time) > 0) continue;
    ++held;
    const Contact contact = collider.contact(x, time);
    const check::ContactKind kind = check::contact_kind(collider, contact, v);
    add(kinds[static_cast<std::size_t>(kind) - 1]);
    if (kind == check::ContactKind::slides)
      add(collider.friction > 0 ? Feature::friction : Feature::no_friction);
    if (collider.sticky) add(Feature::sticky);
    if (!collider.velocity.isZero(0)) add(Feature::moving);
    if (!collider.angular_velocity.isZero(0)) add(Feature::turning);
    v = check::respond(collider, contact, v);
  }
  return held;
}

void Exercised::node_contact(const Scene& scene, const State& before) {
  const Grid& grid = before.grid;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const NodeIndex& n = grid.node[i];
    const Vec3 x = scene.grid.origin + scene.grid.spacing * Vec3(n.i, n.j, n.k);
    const int held = contact(scene, x, grid.v_star[i], before.time,
                             {Feature::node_separates, Feature::node_sticks, Feature::node_slides});
    if (held > 1) add(Feature::node_several);
  }
}

void Exercised::particle_contact(const Scene& scene, const State& before) {
  const Particles& p = before.particles;
  for (std::size_t q = 0; q < p.size(); ++q)
    contact(scene, p.x[q], p.v[q], before.time,
            {Feature::particle_separates, Feature::particle_sticks, Feature::particle_slides});
}

/// Where nothing is clamped F_P stays as it is; else a singular value of F_E is at a limit.
void Exercised::yielding(const Scene& scene, const State& before, const State& after) {
  constexpr double slack = 1e-9;  // rounding of the singular values
  const Particles& p = after.particles;
  for (std::size_t q = 0; q < p.size(); ++q) {
    const Material& material = scene.materials[static_cast<std::size_t>(p.material[q])];
    bool low = false, high = false;
    if (p.F_P[q] != before.particles.F_P[q]) {
      const Vec3 sigma = check::signed_singular_values(p.F_E[q]);
      low = sigma[2] <= material.smallest_elastic_stretch() * (1 + slack);
      high = sigma[0] >= material.largest_elastic_stretch() * (1 - slack);
    }
    add(low && high ? Feature::yields_in_both
        : low       ? Feature::yields_in_compression
        : high      ? Feature::yields_in_stretch
                    : Feature::elastic);
  }
}

void Exercised::add(const Scene& scene, Stage stage, const State& before, const State& after,
                    const StepReport& report) {
  switch (stage) {
    case Stage::rasterize: return places(scene, before, after);
    case Stage::volumes:
      return add(Feature::volume_estimated,
                 std::count(before.particles.V_0.begin(), before.particles.V_0.end(), 0.0));
    case Stage::grid_forces: return strains(before);
    case Stage::grid_collisions: return node_contact(scene, before);
    case Stage::integration:
      iterations_ += report.solver_iterations;
      if (report.solver_iterations > 0) add(Feature::solve);
      if (report.solver_indefinite) add(Feature::indefinite);
      return;
    case Stage::deformation: return yielding(scene, before, after);
    case Stage::particle_collisions: return particle_contact(scene, before);
    case Stage::positions:
      for (std::size_t q = 0; q < before.particles.size(); ++q)
        for (int axis = 0; axis < 3; ++axis) {
          const double period = scene.grid.periodic[axis];
          const double moved = after.particles.x[q][axis] - before.particles.x[q][axis];
          if (period > 0 && std::abs(moved) > period / 2) {
            add(Feature::crosses_seam);
            break;
          }
        }
      return;
    case Stage::grid_velocities:
    case Stage::particle_velocities: return;
  }
}

void Exercised::add_step(TimeStepBound bound) {
  ++steps_;
  switch (bound) {
    case TimeStepBound::fixed: return add(Feature::fixed_step);
    case TimeStepBound::max_step: return add(Feature::step_by_max);
    case TimeStepBound::cfl: return add(Feature::step_by_cfl);
    case TimeStepBound::elastic_cfl: return add(Feature::step_by_elastic_cfl);
  }
}

void Exercised::add(const Exercised& other) {
  for (std::size_t k = 0; k < count_.size(); ++k) count_[k] += other.count_[k];
  steps_ += other.steps_;
  iterations_ += other.iterations_;
}

}  // namespace firn
