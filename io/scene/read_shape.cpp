// SPDX-License-Identifier: BSD-3-Clause
#include <system_error>

#include "io/mesh/mesh_shape.hpp"
#include "io/scene/read_scene.hpp"
#include "io/scene/toml_text.hpp"

namespace firn {

namespace {

Sphere read_sphere(const TomlTable& table) {
  table.allow_only({"type", "center", "radius"});
  return {table.vec3("center", any("m")), table.number("radius", positive(1e9, "m"))};
}

Box read_box(const TomlTable& table) {
  table.allow_only({"type", "min", "max"});
  const Box box = {table.vec3("min", any("m")), table.vec3("max", any("m"))};
  if ((box.min.array() >= box.max.array()).any())
    table.refuse("max", "box without volume", "above min along x, y and z");
  return box;
}

/// A direction: any length > 0 whose square neither under- nor overflows.
Vec3 direction(const TomlTable& table, std::string_view key) {
  const Vec3 value = table.vec3(key, any());
  if (!(value.norm() >= 1e-9)) table.refuse(key, "no direction", "a vector of length >= 1e-09");
  return value;
}

Cylinder read_cylinder(const TomlTable& table) {
  table.allow_only({"type", "center", "axis", "radius", "height"});
  Cylinder cylinder;
  cylinder.center = table.vec3("center", any("m"));
  cylinder.axis = direction(table, "axis");
  cylinder.radius = table.number("radius", positive(1e9, "m"));
  cylinder.height = table.number("height", positive(1e9, "m"));
  return cylinder;
}

HalfSpace read_half_space(const TomlTable& table) {
  table.allow_only({"type", "point", "normal"});
  return {table.vec3("point", any("m")), direction(table, "normal")};
}

/// Loads a shape from `file`; the complaint names both the scene and the file.
template <class Load>
Shape loaded(const TomlTable& table, const std::string& source, Load load) {
  try {
    Shape shape = load();
    if (auto* solid = std::get_if<SolidShape>(&shape)) solid->source = source;
    if (auto* samples = std::get_if<SampledShape>(&shape)) samples->source = source;
    return shape;
  } catch (const InputError& error) {
    throw InputError(table.where("file") + ": " + error.what());
  }
}

Shape read_mesh_shape(const TomlTable& table, ShapeUse use, const SceneContext& context) {
  table.allow_only({"type", "file", "scale", "translate"});
  const std::string file = shape_file(table, context);
  const double scale = table.number_or("scale", positive(1e9), 1);
  const Vec3 translate = table.vec3_or("translate", any("m"), Vec3::Zero());
  const std::string source = "{ type = \"mesh\", file = " + toml_string(file) +
                             ", scale = " + toml_number(scale) +
                             ", translate = " + toml_vector(translate) + " }";
  return loaded(table, source, [&] {
    return use == ShapeUse::body
               ? load_mesh_solid(file, scale, translate)
               : load_mesh_shape(file, scale, translate, context.scene.grid.spacing);
  });
}

Shape read_level_set(const TomlTable& table, const SceneContext& context) {
  table.allow_only({"type", "file", "grid"});
  const std::string file = shape_file(table, context);
  const std::string grid = table.has("grid") ? table.text("grid") : "";
  if (table.has("grid") && (grid.empty() || grid.size() > 256 || one_line(grid) != grid))
    table.refuse("grid", "not a name that a scene can store",
                 "1 to 256 bytes of printable UTF-8; without this key the first level set");
  const std::string named = grid.empty() ? "" : ", grid = " + toml_string(grid);
  const std::string source = "{ type = \"level-set\", file = " + toml_string(file) + named + " }";
  return loaded(table, source, [&] { return load_level_set_shape(file, grid); });
}

constexpr const char* body_shapes = "\"sphere\", \"box\", \"cylinder\", \"mesh\", \"particles\"";
constexpr const char* collider_shapes =
    "\"sphere\", \"box\", \"cylinder\", \"half-space\", \"mesh\", \"level-set\"";

/// Shapes that exist, but not for this use.
void refuse_misfit(const TomlTable& table, ShapeUse use) {
  if (use == ShapeUse::collider && table.is_text("type", "particles"))
    table.refuse("type", "a collider cannot consist of particles", collider_shapes);
  if (use == ShapeUse::body && table.is_text("type", "half-space"))
    table.refuse("type", "a body cannot fill half of space", body_shapes);
  if (use == ShapeUse::body && table.is_text("type", "level-set"))
    table.refuse("type", "level sets are for colliders", body_shapes);
}

}  // namespace

std::string shape_file(const TomlTable& shape, const SceneContext& context) {
  const std::filesystem::path file = context.base_dir / shape.text("file");
  const std::string path = std::filesystem::absolute(file).lexically_normal().string();
  if (path.size() > 4096 || one_line(path) != path)
    shape.refuse("file", "not a path that a scene can store",
                 "at most 4096 bytes of printable UTF-8");
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) shape.refuse("file", "no such file", "a readable file");
  if (std::filesystem::is_directory(status)) shape.refuse("file", "a directory", "a readable file");
  context.files.push_back(path);
  return path;
}

Shape read_shape(const TomlTable& table, ShapeUse use, const SceneContext& context) {
  refuse_misfit(table, use);
  const char* allowed = use == ShapeUse::body ? body_shapes : collider_shapes;
  const std::string type = table.word("type", allowed);
  if (type == "sphere") return read_sphere(table);
  if (type == "box") return read_box(table);
  if (type == "cylinder") return read_cylinder(table);
  if (type == "half-space") return read_half_space(table);
  if (type == "mesh") return read_mesh_shape(table, use, context);
  if (type == "level-set") return read_level_set(table, context);
  table.refuse("type", "unknown value", allowed);
}

}  // namespace firn
