// SPDX-License-Identifier: BSD-3-Clause
/// Error bounds of steps 5 and 9: contact (contact_outcomes.hpp).

#include <algorithm>
#include <cmath>

#include "verification/check/bounds.hpp"

namespace firn::check {

void BoundModel::grid_collisions(const State& before, const State& after) {
  const Grid& grid = before.grid;
  const double h = scene_.grid.spacing;
  const bool projectors = !after.grid.free_directions.empty();
  bounds_.free_directions.assign(after.grid.free_directions.size(), 0);
  doubtful_.clear();
  doubtful_stage_ = Stage::grid_collisions;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec3 ijk(grid.node[i].i, grid.node[i].j, grid.node[i].k);
    const Vec3 x = scene_.grid.origin + h * ijk;
    const Vec3 x_error = 2 * r_.eps * (scene_.grid.origin.cwiseAbs() + h * ijk.cwiseAbs());
    ContactOutcomes contact = contact_outcomes(
        scene_, {x, x_error, grid.v_star[i], bounds_.v_star[i]}, before.time, r_.eps, projectors);
    bounds_.v_star[i] = contact.outcomes[0].v_error;
    if (projectors) bounds_.free_directions[i] = contact.outcomes[0].free_error;
    if (contact.normal >= 0) bounds_.node_cause[i] = {Cause::Kind::normal, contact.normal};
    if (contact.outcomes.size() > 1)
      doubtful_.push_back({i, contact.doubtful, std::move(contact.outcomes)});
  }
}

void BoundModel::particle_collisions(const State& before) {
  const Particles& p = before.particles;
  doubtful_.clear();
  doubtful_stage_ = Stage::particle_collisions;
  for (std::size_t q = 0; q < p.size(); ++q) {
    ContactOutcomes contact = contact_outcomes(scene_, {p.x[q], bounds_.x[q], p.v[q], bounds_.v[q]},
                                               before.time, r_.eps, false);
    bounds_.v[q] = contact.outcomes[0].v_error;
    if (contact.normal >= 0) bounds_.particle_cause[q] = {Cause::Kind::normal, contact.normal};
    if (contact.outcomes.size() > 1)
      doubtful_.push_back({q, contact.doubtful, std::move(contact.outcomes)});
  }
}

void BoundModel::choose(const DoubtfulContact& contact, int outcome) {
  const bool node = doubtful_stage_ == Stage::grid_collisions;
  double& v = (node ? bounds_.v_star : bounds_.v)[contact.index];
  if (outcome >= 0) {
    const ContactOutcome& chosen = contact.outcomes[static_cast<std::size_t>(outcome)];
    v = chosen.v_error;
    if (!bounds_.free_directions.empty() && node)
      bounds_.free_directions[contact.index] = chosen.free_error;
    return;
  }
  for (const ContactOutcome& o : contact.outcomes)
    v = std::max(v, (o.v - contact.outcomes[0].v).norm() + o.v_error);
  if (!bounds_.free_directions.empty() && node) bounds_.free_directions[contact.index] = unbounded;
  (node ? bounds_.node_cause : bounds_.particle_cause)[contact.index] = {Cause::Kind::contact,
                                                                         contact.collider};
}

}  // namespace firn::check
