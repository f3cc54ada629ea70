// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "io/scene/read_scene.hpp"
#include "io/trajectory/reader.hpp"

namespace firn {

namespace {

constexpr double farthest_node = 1073741824;  // 2^30: node indices are 32-bit integers

std::int32_t read_material_name(const TomlTable& table, const std::vector<Material>& materials) {
  const std::string name = table.text("material");
  std::string known;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    if (materials[i].name == name) return static_cast<std::int32_t>(i);
    known += (known.empty() ? "\"" : ", \"") + one_line(materials[i].name, 60) + "\"";
  }
  table.refuse("material", "unknown material", known);
}

void check_extent(const TomlTable& table, const Bounds& bounds, const GridSettings& grid) {
  const Vec3 low = (bounds.min - grid.origin) / grid.spacing;
  const Vec3 high = (bounds.max - grid.origin) / grid.spacing;
  if (low.minCoeff() < -farthest_node || high.maxCoeff() > farthest_node)
    throw InputError(table.where("shape"), "too far from the grid's origin",
                     to_text(std::max(high.maxCoeff(), -low.minCoeff()) * grid.spacing) + " m",
                     "at most 2^30 h = " + to_text(farthest_node * grid.spacing) + " m");
  for (int axis = 0; axis < 3; ++axis) {
    const double period = grid.periodic[axis];
    // Both are sums of a few decimal fractions, each rounded by eps/2 of its size.
    const double roundoff = 8 * std::numeric_limits<double>::epsilon() *
                            std::max(std::abs(bounds.min[axis]), std::abs(bounds.max[axis]));
    if (period > 0 && bounds.max[axis] - bounds.min[axis] > period + roundoff) {
      constexpr const char* names[] = {"x", "y", "z"};
      throw InputError(
          table.where("shape"), std::string("wider than the period along ") + names[axis],
          to_text(bounds.max[axis] - bounds.min[axis]) + " m", "at most " + to_text(period) + " m");
    }
  }
}

/// Lattice sampling needs n³ particles in a cell.
void check_cube(const TomlTable& table, int particles_per_cell) {
  const int n = static_cast<int>(std::lround(std::cbrt(particles_per_cell)));
  if (n * n * n != particles_per_cell)
    table.refuse("particles_per_cell", "not a cube number, which sampling = \"lattice\" needs",
                 "1, 8, 27, 64, 125, 216, 343, 512, 729 or 1000");
}

void read_sampling(const TomlTable& table, Body& body) {
  constexpr Sampling samplings[] = {Sampling::lattice, Sampling::jittered, Sampling::poisson};
  body.sampling = samplings[table.choice("sampling", {"lattice", "jittered", "poisson"})];
  body.particles_per_cell = static_cast<int>(table.integer("particles_per_cell", 1, 1000));
  if (body.sampling == Sampling::lattice) check_cube(table, body.particles_per_cell);
  body.seed = static_cast<std::uint64_t>(table.integer("seed", 0, INT64_MAX));
  if (table.choice("volumes", {"estimated", "exact"}) == 1) body.volumes = VolumeSource::exact;
  if (body.volumes == VolumeSource::exact && body.sampling == Sampling::poisson)
    table.refuse("volumes", "poisson sampling has no exact volumes", "\"estimated\"");
}

/// The last frame of a trajectory. It brings its own masses, volumes and
/// deformations, so that nothing about sampling is left to say.
void read_particles(const TomlTable& table, const SceneContext& context, Body& body) {
  for (const char* key : {"particles_per_cell", "sampling", "seed", "volumes"})
    if (table.has(key))
      table.refuse(key, "not allowed with shape = \"particles\"",
                   "no such key: the file contains the particles");
  if (table.has("angular_velocity"))
    table.refuse("angular_velocity", "not allowed with shape = \"particles\"",
                 "velocity, which is added to the velocities in the file");
  const TomlTable shape = table.table("shape");
  shape.allow_only({"type", "file"});
  if (context.options.scale != 1)
    shape.refuse("file", "particles from a file cannot be refined", "scale 1");
  body.sampling = Sampling::from_file;
  body.file = shape_file(shape, context);
  try {
    body.particles = read_last_frame(body.file);
  } catch (const InputError& error) {
    throw InputError(shape.where("file") + ": " + error.what());
  }
  for (std::int32_t& material : body.particles.material) material = body.material;
  Bounds bounds{context.scene.grid.origin, context.scene.grid.origin};
  for (const Vec3& x : body.particles.x) {
    bounds.min = bounds.min.cwiseMin(x);
    bounds.max = bounds.max.cwiseMax(x);
  }
  check_extent(table, bounds, context.scene.grid);
}

}  // namespace

Body read_body(const TomlTable& table, const SceneContext& context) {
  table.allow_only({"material", "shape", "particles_per_cell", "sampling", "seed", "volumes",
                    "velocity", "angular_velocity"});
  Body body;
  body.material = read_material_name(table, context.scene.materials);
  body.velocity = table.vec3_or("velocity", any("m/s"), Vec3::Zero());
  if (table.table("shape").is_text("type", "particles")) {
    read_particles(table, context, body);
    return body;
  }
  body.shape = read_shape(table.table("shape"), ShapeUse::body, context);
  check_extent(table, *bounds(body.shape), context.scene.grid);
  read_sampling(table, body);
  body.angular_velocity = table.vec3_or("angular_velocity", any("rad/s"), Vec3::Zero());
  return body;
}

Collider read_collider(const TomlTable& table, const SceneContext& context) {
  table.allow_only(
      {"shape", "inside", "friction", "sticky", "velocity", "angular_velocity", "center"});
  Collider collider;
  collider.shape = read_shape(table.table("shape"), ShapeUse::collider, context);
  collider.inside = table.boolean_or("inside", false);
  collider.sticky = table.boolean_or("sticky", false);
  if (collider.sticky && table.has("friction"))
    table.refuse("friction", "friction given for a sticky collider",
                 "either friction or sticky = true");
  if (!collider.sticky && !table.has("friction"))
    table.refuse("friction", "missing", "either friction in [0, 1e+06] or sticky = true");
  if (!collider.sticky) collider.friction = table.number("friction", closed(0, 1e6));
  collider.velocity = table.vec3_or("velocity", any("m/s"), Vec3::Zero());
  collider.angular_velocity = table.vec3_or("angular_velocity", any("rad/s"), Vec3::Zero());
  collider.center = table.vec3_or("center", any("m"), center(collider.shape));
  return collider;
}

}  // namespace firn
