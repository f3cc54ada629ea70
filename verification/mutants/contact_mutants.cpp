// SPDX-License-Identifier: BSD-3-Clause
/// Stages 5 and 9: collisions of nodes and of particles.

#include <algorithm>
#include <cmath>

#include "reference/collision.hpp"
#include "verification/mutants/stages.hpp"

namespace firn::mutants {

namespace {

using reference::ContactMode;
using Collide = std::function<ContactMode(const Collider&, const Contact&, Vec3& v)>;

/// Takes n out of the space onto which `free` projects.
void hold(const Vec3& n, Mat3& free) {
  const Vec3 rest = free * n;
  if (rest.squaredNorm() > 1e-16) free -= rest * rest.transpose() / rest.squaredNorm();
}

/// Step 5 with a collision rule of one's own, for φ ≤ `reach` · h.
void collide_nodes(const Step& s, const Collide& collide, double reach = 0) {
  Grid& grid = s.grid;
  const bool record = s.scene.semi_implicit();
  grid.free_directions.assign(record ? grid.size() : 0, Mat3::Identity());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.m[i] == 0) continue;
    const NodeIndex& n = grid.node[i];
    const Vec3 x_i = s.scene.grid.origin + s.scene.grid.spacing * Vec3(n.i, n.j, n.k);
    for (const Collider& collider : s.scene.colliders) {
      Contact contact = collider.contact(x_i, s.time);
      if (contact.phi > reach * s.scene.grid.spacing) continue;
      contact.phi = std::min(contact.phi, 0.0);
      const ContactMode mode = collide(collider, contact, grid.v_star[i]);
      if (!record || mode == ContactMode::none) continue;
      if (mode == ContactMode::sticks) grid.free_directions[i].setZero();
      if (mode == ContactMode::slides) hold(contact.normal, grid.free_directions[i]);
    }
  }
}

Patch on_nodes(Collide collide, double reach = 0) {
  return around(Stage::grid_collisions,
                [=](const StageFunction&, const Step& s) { collide_nodes(s, collide, reach); });
}

/// Same rule for particles, at their positions.
void collide_particles(const Step& s, const Collide& collide) {
  for (std::size_t p = 0; p < s.particles.size(); ++p)
    for (const Collider& collider : s.scene.colliders) {
      const Contact contact = collider.contact(s.particles.x[p], s.time);
      if (contact.phi <= 0) collide(collider, contact, s.particles.v[p]);
    }
}

/// v_t' = (1 + μ v_n/‖v_t‖) v_t without asking first whether that would turn it around.
ContactMode never_sticks(const Collider& collider, const Contact& c, Vec3& v) {
  if (collider.sticky) return reference::collide(collider, c, v);
  const Vec3 v_rel = v - c.velocity;
  const double v_n = v_rel.dot(c.normal);
  if (v_n >= 0) return ContactMode::none;
  const Vec3 v_t = v_rel - c.normal * v_n;
  if (v_t.norm() > 0)
    v = (1 + collider.friction * v_n / v_t.norm()) * v_t + c.velocity;
  else
    v = c.velocity;
  return ContactMode::slides;
}

/// Nothing to push back, nothing to do: a sticky collider lets go of what moves along it exactly.
ContactMode sticks_if_pushed(const Collider& collider, const Contact& c, Vec3& v) {
  if ((v - c.velocity).dot(c.normal) == 0) return ContactMode::none;
  return reference::collide(collider, c, v);
}

/// v_n > 0 is asked for, not v_n ≥ 0: what moves along the surface slides without friction, and
/// the solve holds its normal direction.
ContactMode holds_what_slides_along(const Collider& collider, const Contact& c, Vec3& v) {
  if (!collider.sticky && (v - c.velocity).dot(c.normal) == 0) return ContactMode::slides;
  return reference::collide(collider, c, v);
}

/// ‖v_t‖ < −μ v_n sticks, not ≤: 0/0 without friction and without v_t.
ContactMode divides_by_no_slip(const Collider& collider, const Contact& c, Vec3& v) {
  const Vec3 v_rel = v - c.velocity;
  const double v_n = v_rel.dot(c.normal);
  const Vec3 v_t = v_rel - c.normal * v_n;
  const double speed_t = v_t.norm();
  if (collider.sticky || v_n >= 0 || speed_t != -collider.friction * v_n)
    return reference::collide(collider, c, v);
  v = (1 + collider.friction * v_n / speed_t) * v_t + c.velocity;
  return ContactMode::slides;
}

/// The friction is measured by the whole speed, not by its tangential part.
ContactMode friction_by_whole_speed(const Collider& collider, const Contact& c, Vec3& v) {
  if (collider.sticky) return reference::collide(collider, c, v);
  const Vec3 v_rel = v - c.velocity;
  const double v_n = v_rel.dot(c.normal), speed = v_rel.norm();
  if (v_n >= 0) return ContactMode::none;
  const Vec3 v_t = v_rel - c.normal * v_n;
  if (speed <= -collider.friction * v_n) {
    v = c.velocity;
    return ContactMode::sticks;
  }
  v = (1 + collider.friction * v_n / speed) * v_t + c.velocity;
  return ContactMode::slides;
}

/// Nodes on their way out are held as well.
ContactMode holds_what_leaves(const Collider& collider, const Contact& c, Vec3& v) {
  Contact other = c;
  if ((v - c.velocity).dot(c.normal) > 0) other.normal = -c.normal;
  return reference::collide(collider, other, v);
}

/// v_rel' is stored: v_co was subtracted and never added again.
ContactMode forgets_to_add(const Collider& collider, const Contact& c, Vec3& v) {
  const ContactMode mode = reference::collide(collider, c, v);
  if (mode != ContactMode::none) v -= c.velocity;
  return mode;
}

/// The normal as the scene file has it, of any length.
ContactMode raw_normal(const Collider& collider, const Contact& c, Vec3& v) {
  Contact raw = c;
  if (const auto* plane = std::get_if<HalfSpace>(&collider.shape))
    raw.normal *= plane->normal.norm();
  return reference::collide(collider, raw, v);
}

void add_grid_collisions(std::vector<Mutant>& list) {
  Adder add(list, Stage::grid_collisions);
  const auto right = reference::collide;
  add("friction_sign", "friction speeds the node up", "v_n is negative",
      with_other_colliders(Stage::grid_collisions, [](Collider& c) { c.friction = -c.friction; }));
  add("collider_rotation_forgotten",
      "v_co is the velocity of the collider's centre: ω × r is missing",
      "written for colliders that do not turn",
      with_other_colliders(Stage::grid_collisions,
                           [](Collider& c) { c.angular_velocity.setZero(); }))
      .needs = "a collider that rotates";
  add("relative_velocity_not_restored",
      "v_co is subtracted before the collision and never added again", slip,
      on_nodes(forgets_to_add))
      .needs = "a collider that moves";
  add("sticky_slides", "a sticky collider is treated as one with friction", slip,
      with_other_colliders(Stage::grid_collisions, [](Collider& c) { c.sticky = false; }))
      .needs = "a sticky collider";
  Mutant& raw = add("normal_not_normalized", "n = ∇φ as it comes, of any length, in steps 5 and 9",
                    "right for a normalized plane", [](Stages& stages) {
                      on_nodes(raw_normal)(stages);
                      stages[Stage::particle_collisions] = [](const Step& s) {
                        collide_particles(s, raw_normal);
                      };
                    });
  raw.several = true;
  raw.needs = "a half-space whose normal is not of length 1";
  add("leaving_nodes_held", "nodes that move out of the collider (v_n ≥ 0) are stopped too", slip,
      on_nodes(holds_what_leaves));
  add("friction_by_whole_speed",
      "the friction factor is 1 + μ v_n/‖v_rel‖ instead of 1 + μ v_n/‖v_t‖", slip,
      on_nodes(friction_by_whole_speed));
  add("friction_never_sticks", "the case ‖v_t‖ ≤ −μ v_n is missing: friction turns v_t around",
      slip, on_nodes(never_sticks));
  const auto exactly = [](Mutant& mutant, const char* needs) {
    mutant.needs = needs;
    mutant.check_sees_it = false;
  };
  exactly(add("sticky_node_slips_along", "a sticky collider does nothing at a node where v_n = 0",
              "nothing is pushed back there", on_nodes(sticks_if_pushed)),
          "a sticky collider and a motion exactly along it");
  exactly(add("sliding_along_is_held",
              "v_n > 0 is left alone, not v_n ≥ 0: the solve holds n of a node that moves along",
              slip, on_nodes(holds_what_slides_along)),
          "semi-implicit steps and a motion exactly along a collider");
  exactly(add("no_slip_divided_by", "‖v_t‖ < −μ v_n sticks, not ≤: 0/0 where both are 0", slip,
              on_nodes(divides_by_no_slip)),
          "a collider without friction and a motion exactly along its normal");
  add("contact_a_cell_away", "nodes collide at φ ≤ h instead of φ ≤ 0",
      "to hide the gap between snow and ground", on_nodes(right, 1));
  add("only_first_collider", "the loop over colliders ends at the first", "written for one ground",
      in_other_scene(Stage::grid_collisions,
                     [](Scene& scene, const Step&) {
                       if (scene.colliders.size() > 1) scene.colliders.resize(1);
                     }))
      .needs = "two colliders";
  add("colliders_in_reverse_order", "the last collider of the scene is applied first",
      "a list built by pushing to its front",
      in_other_scene(Stage::grid_collisions,
                     [](Scene& scene, const Step&) {
                       std::reverse(scene.colliders.begin(), scene.colliders.end());
                     }))
      .needs = "two colliders that touch";
  add("collider_of_the_next_step", "φ, n and v_co are taken at tⁿ + Δt",
      "colliders were moved first",
      around(Stage::grid_collisions,
             [](const StageFunction& run, const Step& s) {
               run({s.scene, s.time + s.dt, s.dt, s.threads, s.particles, s.stencils, s.grid,
                    s.report});
             }))
      .needs = "a collider that rotates or moves";
}

void add_particle_collisions(std::vector<Mutant>& list) {
  Adder add(list, Stage::particle_collisions);
  add("particle_collisions_skipped", "step 9 does nothing", "the grid has collided already",
      around(Stage::particle_collisions, [](const StageFunction&, const Step&) {}));
  add("particles_without_friction", "particles slide freely: friction was left to the grid", slip,
      with_other_colliders(Stage::particle_collisions, [](Collider& c) { c.friction = 0; }));
  add("collided_at_the_new_position", "step 9 tests φ at x_p + Δt v_p",
      "steps 9 and 10 in one loop",
      around(Stage::particle_collisions, [](const StageFunction& run, const Step& s) {
        const std::vector<Vec3> x = s.particles.x;
        for (std::size_t p = 0; p < x.size(); ++p) s.particles.x[p] += s.dt * s.particles.v[p];
        run(s);
        s.particles.x = x;
      }));
  Mutant& sticky = add(
      "sticky_particle_slips_along", "a sticky collider does nothing to a particle whose v_n = 0",
      "nothing is pushed back there",
      around(Stage::particle_collisions,
             [](const StageFunction&, const Step& s) { collide_particles(s, sticks_if_pushed); }));
  sticky.needs = "a sticky collider and a motion exactly along it";
  sticky.check_sees_it = false;
  add("particles_pushed_out", "particles inside a collider are moved onto its surface",
      "a game engine's habit", after(Stage::particle_collisions, [](const Step& s) {
        for (Vec3& x : s.particles.x)
          for (const Collider& collider : s.scene.colliders) {
            const Contact c = collider.contact(x, s.time);
            if (c.phi < 0) x -= c.phi * c.normal;
          }
      }));
}

}  // namespace

void add_contact_mutants(std::vector<Mutant>& list) {
  add_grid_collisions(list);
  add_particle_collisions(list);
}

}  // namespace firn::mutants
