// SPDX-License-Identifier: BSD-3-Clause
/// From a scene that fails to a smaller one that still does. Greedy: of the list of ways
/// to make a scene simpler, the first that keeps the failure is taken, again and again.

#include <algorithm>
#include <limits>
#include <vector>

#include "firn/error.hpp"
#include "verification/fuzz/random/compare.hpp"

namespace firn {

namespace {

using Change = std::function<void(RandomCase&)>;

void add(std::vector<Change>& list, bool useful, Change change) {
  if (useful) list.push_back(std::move(change));
}

/// Half the size about the shape's centre; false for shapes that have no size of their own.
bool halve(Shape& shape) {
  if (auto* s = std::get_if<Sphere>(&shape)) {
    s->radius /= 2;
  } else if (auto* b = std::get_if<Box>(&shape)) {
    const Vec3 middle = center(shape), half = (b->max - b->min) / 4;
    *b = Box{middle - half, middle + half};
  } else if (auto* c = std::get_if<Cylinder>(&shape)) {
    c->radius /= 2;
    c->height /= 2;
  } else {
    return false;
  }
  return true;
}

/// One cell of the grid at the middle of the shape, or two along x.
Box cells_at(const Shape& shape, const GridSettings& grid, int count) {
  const Vec3 middle = (center(shape) - grid.origin) / grid.spacing;
  const Vec3 low = grid.origin + grid.spacing * Vec3(middle.array().floor());
  return {low, low + grid.spacing * Vec3(count, 1, 1)};
}

void simplify_body(std::vector<Change>& list, const GridSettings& grid, const Body& body,
                   std::size_t i) {
  const auto* box = std::get_if<Box>(&body.shape);
  for (const int count : {1, 2}) {
    const Box cells = cells_at(body.shape, grid, count);
    // A box that is small already would only move, from one cell to the next and back.
    const bool larger =
        box == nullptr || (box->max - box->min).sum() > (count + 2.5) * grid.spacing;
    add(list, larger, [=](RandomCase& c) {
      c.scene.bodies[i].shape = cells;
      c.scene.bodies[i].sampling = Sampling::lattice;
      c.scene.bodies[i].particles_per_cell = 1;
    });
  }
  Shape smaller = body.shape;
  add(list, halve(smaller), [=](RandomCase& c) { c.scene.bodies[i].shape = smaller; });
  add(list, body.particles_per_cell > 1,
      [=](RandomCase& c) { c.scene.bodies[i].particles_per_cell = 1; });
  add(list, body.particles_per_cell > 2 && body.sampling != Sampling::lattice,
      [=](RandomCase& c) { c.scene.bodies[i].particles_per_cell /= 2; });
  add(list, body.sampling != Sampling::lattice, [=](RandomCase& c) {
    c.scene.bodies[i].sampling = Sampling::lattice;
    c.scene.bodies[i].particles_per_cell = 1;
  });
  add(list, !body.angular_velocity.isZero(0),
      [=](RandomCase& c) { c.scene.bodies[i].angular_velocity.setZero(); });
  add(list, !body.velocity.isZero(0), [=](RandomCase& c) { c.scene.bodies[i].velocity.setZero(); });
  add(list, body.volumes == VolumeSource::estimated && body.sampling != Sampling::poisson,
      [=](RandomCase& c) { c.scene.bodies[i].volumes = VolumeSource::exact; });
  add(list, body.material != 0, [=](RandomCase& c) { c.scene.bodies[i].material = 0; });
}

void simplify_collider(std::vector<Change>& list, const Collider& collider, std::size_t i) {
  add(list, !collider.angular_velocity.isZero(0),
      [=](RandomCase& c) { c.scene.colliders[i].angular_velocity.setZero(); });
  add(list, !collider.velocity.isZero(0),
      [=](RandomCase& c) { c.scene.colliders[i].velocity.setZero(); });
  add(list, collider.friction > 0, [=](RandomCase& c) { c.scene.colliders[i].friction = 0; });
  add(list, collider.inside, [=](RandomCase& c) { c.scene.colliders[i].inside = false; });
}

/// What could be simpler, the largest steps first.
std::vector<Change> simplifications(const RandomCase& now) {
  std::vector<Change> list;
  const Scene& scene = now.scene;
  add(list, now.start_step > 0, [](RandomCase& c) { c.start_step = 0; });
  add(list, now.start_step > 1, [](RandomCase& c) { c.start_step /= 2; });
  add(list, now.start_step > 0, [](RandomCase& c) { --c.start_step; });
  add(list, now.steps > 1, [](RandomCase& c) { c.steps = 1; });
  add(list, now.steps > 1, [](RandomCase& c) { --c.steps; });
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    add(list, scene.bodies.size() > 1, [=](RandomCase& c) {
      c.scene.bodies.erase(c.scene.bodies.begin() + static_cast<std::ptrdiff_t>(i));
    });
  for (std::size_t i = 0; i < scene.colliders.size(); ++i)
    add(list, true, [=](RandomCase& c) {
      c.scene.colliders.erase(c.scene.colliders.begin() + static_cast<std::ptrdiff_t>(i));
    });
  const bool one_material = std::all_of(scene.bodies.begin(), scene.bodies.end(),
                                        [](const Body& body) { return body.material == 0; });
  add(list, one_material && scene.materials.size() > 1,
      [](RandomCase& c) { c.scene.materials.resize(1); });
  add(list, !scene.gravity.isZero(0), [](RandomCase& c) { c.scene.gravity.setZero(); });
  add(list, scene.time.adaptive, [](RandomCase& c) {
    c.scene.time.step = c.scene.time.max_step;
    c.scene.time.adaptive = false;
  });
  for (int axis = 0; axis < 3; ++axis)
    add(list, scene.grid.periodic[axis] > 0,
        [=](RandomCase& c) { c.scene.grid.periodic[axis] = 0; });
  add(list, scene.semi_implicit(),
      [](RandomCase& c) { c.scene.integrator.type = IntegratorType::explicit_euler; });
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    add(list, scene.materials[i].hardening > 0,
        [=](RandomCase& c) { c.scene.materials[i].hardening = 0; });
    const double none = std::numeric_limits<double>::infinity();
    add(list, scene.materials[i].critical_stretch < none, [=](RandomCase& c) {
      c.scene.materials[i].critical_compression = none;
      c.scene.materials[i].critical_stretch = none;
    });
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    simplify_body(list, scene.grid, scene.bodies[i], i);
  for (std::size_t i = 0; i < scene.colliders.size(); ++i)
    simplify_collider(list, scene.colliders[i], i);
  for (const double flip : {1.0, 0.0})
    add(list, scene.flip > 0 && scene.flip < 1, [=](RandomCase& c) { c.scene.flip = flip; });
  return list;
}

}  // namespace

RandomCase shrink(RandomCase failing, const std::function<bool(const RandomCase&)>& fails,
                  std::int64_t max_particles, int most_attempts) {
  int attempts = 0;
  for (bool smaller = true; smaller && attempts < most_attempts;) {
    smaller = false;
    for (const Change& change : simplifications(failing)) {
      RandomCase candidate = failing;
      change(candidate);
      try {
        candidate.scene = through_toml(candidate.scene, max_particles);
      } catch (const InputError&) {
        continue;  // no scene any more: a body without particles
      }
      if (++attempts > most_attempts) break;
      if (!fails(candidate)) continue;
      failing = std::move(candidate);
      smaller = true;
      break;
    }
  }
  return failing;
}

}  // namespace firn
