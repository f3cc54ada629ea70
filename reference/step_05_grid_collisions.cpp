// SPDX-License-Identifier: BSD-3-Clause
#include "reference/collision.hpp"
#include "reference/failure.hpp"
#include "reference/steps.hpp"

namespace firn::reference {

namespace {

/// Takes the direction n out of the space onto which `free` projects. Only the
/// part of n that is still free counts: two colliders need not be orthogonal.
void hold(const Vec3& n, Mat3& free) {
  const Vec3 rest = free * n;
  // Normals which agree to 1e-8, the square root of roundoff, are the same normal.
  if (rest.squaredNorm() <= 1e-16) return;
  free -= rest * rest.transpose() / rest.squaredNorm();
}

}  // namespace

/// Step 5. Grid-based body collisions (Stomakhin et al. 2013, §4.1 step 5 and
/// section 8) at the nodes with φ(x_i) ≤ 0; several colliders in scene order.
///
/// For step 6 it records the directions that contact leaves free: all for a node
/// without contact, none for one that sticks, those normal to n for one that
/// slides (n of each collider).
void grid_collisions(const Scene& scene, double t, Grid& grid) {
  const bool record = scene.semi_implicit();
  grid.free_directions.assign(record ? grid.size() : 0, Mat3::Identity());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.m[i] == 0) continue;
    const NodeIndex& n = grid.node[i];
    const Vec3 x_i = scene.grid.origin + scene.grid.spacing * Vec3(n.i, n.j, n.k);
    for (const Collider& collider : scene.colliders) {
      if (collider.phi(x_i, t) > 0) continue;
      const Contact contact = collider.contact(x_i, t);
      const ContactMode mode = collide(collider, contact, grid.v_star[i]);
      if (!record || mode == ContactMode::none) continue;
      if (mode == ContactMode::sticks) grid.free_directions[i].setZero();
      if (mode == ContactMode::slides) hold(contact.normal, grid.free_directions[i]);
    }
    if (!finite(grid.v_star[i]))
      fail_at_node(Stage::grid_collisions, grid, i, "velocity is not finite");
  }
}

}  // namespace firn::reference
