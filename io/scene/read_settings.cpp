// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>

#include "io/scene/read_scene.hpp"

namespace firn {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Cubic B-splines reach 2 h to either side: along a shorter axis a particle
// would meet the same node twice.
constexpr double fewest_period_nodes = 4, most_period_nodes = 1048576;

/// A length or time that refinement divides by `scale`.
double refined(const TomlTable& table, std::string_view key, const Range& range, double scale) {
  const double value = table.number(key, range) / scale;
  if (!range.holds(value))
    table.refuse(key, "out of range when refined by " + to_text(scale), range.text());
  return value;
}

/// Period as a whole multiple of h, or 0.
double whole_period(const TomlTable& table, int axis, double period, double h) {
  if (period == 0) return 0;
  const double nodes = period / h, whole = std::round(nodes);
  // Decimal fractions such as 0.05 carry a relative error of eps each, and a
  // refinement adds another: anything beyond 8 eps is no rounding.
  const double eps = std::numeric_limits<double>::epsilon();
  if (std::abs(nodes - whole) > 8 * eps * whole || whole < fewest_period_nodes ||
      whole > most_period_nodes) {
    const char* names[] = {"x", "y", "z"};
    table.refuse("periodic", std::string("not a period along ") + names[axis],
                 "0 (open) or a whole multiple of h = " + to_text(h) + " m, from 4 h to 1048576 h");
  }
  return whole * h;
}

/// θ_c or θ_s; "inf" is allowed, but only for both.
double critical(const TomlTable& table, std::string_view key, const Range& range) {
  if (table.is_infinite(key)) return infinity;
  const std::string allowed = "a number in " + range.text() + ", or \"inf\" for both";
  if (table.has(key) && !table.is_number(key)) table.refuse(key, "wrong type", allowed);
  return table.number(key, range);
}

Material read_material(const TomlTable& table) {
  table.allow_only({"name", "youngs_modulus", "poisson_ratio", "density", "hardening",
                    "critical_compression", "critical_stretch"});
  Material material;
  material.name = table.text("name");
  material.youngs_modulus = table.number("youngs_modulus", positive(1e15, "Pa"));
  material.poisson_ratio = table.number("poisson_ratio", open(-1, 0.5));
  material.density = table.number("density", closed(1e-6, 1e9, "kg/m^3"));
  material.hardening = table.number("hardening", closed(0, 1000));
  material.critical_compression = critical(table, "critical_compression", open(0, 1));
  material.critical_stretch = critical(table, "critical_stretch", positive(1000));
  if (std::isinf(material.critical_compression) != std::isinf(material.critical_stretch))
    table.refuse(
        std::isinf(material.critical_stretch) ? "critical_compression" : "critical_stretch",
        "the other limit is infinite", "\"inf\" for both, or numbers for both");
  return material;
}

}  // namespace

GridSettings read_grid(const TomlTable& table, double scale) {
  table.allow_only({"spacing", "origin", "periodic"});
  GridSettings grid;
  grid.spacing = refined(table, "spacing", closed(1e-6, 1e6, "m"), scale);
  grid.origin = table.vec3_or("origin", any("m"), Vec3::Zero());
  grid.periodic = table.vec3_or("periodic", closed(0, 1e9, "m"), Vec3::Zero());
  for (int axis = 0; axis < 3; ++axis)
    grid.periodic[axis] = whole_period(table, axis, grid.periodic[axis], grid.spacing);
  return grid;
}

TimeSettings read_time(const TomlTable& table, double scale) {
  table.allow_only({"end", "step", "max_step", "cfl", "elastic_cfl", "frames_per_second"});
  const Range step_range = closed(1e-12, 1e6, "s"), courant_range = positive(100);
  const std::string either = "either step, or max_step, cfl and elastic_cfl";
  TimeSettings time;
  time.end = table.number("end", closed(0, 1e9, "s"));
  time.adaptive = table.has("max_step") || table.has("cfl") || table.has("elastic_cfl");
  if (time.adaptive) {
    if (table.has("step")) table.refuse("step", "fixed and adaptive step together", either);
    time.max_step = refined(table, "max_step", step_range, scale);
    time.cfl = table.number("cfl", courant_range);
    time.elastic_cfl = table.number("elastic_cfl", courant_range);
  } else {
    if (!table.has("step")) table.refuse("step", "missing", either);
    time.step = refined(table, "step", step_range, scale);
  }
  time.frames_per_second = table.number("frames_per_second", positive(1e9, "1/s"));
  return time;
}

IntegratorSettings read_integrator(const TomlTable& table) {
  table.allow_only({"type", "implicitness", "tolerance", "max_iterations"});
  IntegratorSettings integrator;
  const bool semi_implicit = table.choice("type", {"explicit", "semi-implicit"}) == 1;
  if (semi_implicit) integrator.type = IntegratorType::semi_implicit;
  // An explicit scene may state them so that one word switches between the two.
  if (semi_implicit || table.has("implicitness"))
    integrator.implicitness = table.number("implicitness", closed(0, 1));
  if (semi_implicit || table.has("tolerance"))
    integrator.tolerance = table.number("tolerance", open(0, 1));
  if (semi_implicit || table.has("max_iterations"))
    integrator.max_iterations = static_cast<int>(table.integer("max_iterations", 1, 1000000));
  return integrator;
}

std::vector<Material> read_materials(const std::vector<TomlTable>& tables) {
  std::vector<Material> materials;
  for (const TomlTable& table : tables) {
    Material material = read_material(table);
    for (const Material& earlier : materials)
      if (earlier.name == material.name)
        table.refuse("name", "duplicate material name", "a name that no other material has");
    materials.push_back(std::move(material));
  }
  return materials;
}

}  // namespace firn
