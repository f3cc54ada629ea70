#include "io/scene/read_scene.hpp"

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

HalfSpace read_half_space(const TomlTable& table, ShapeUse use) {
  if (use == ShapeUse::body)
    table.refuse("type", "a body cannot fill half of space",
                 "\"sphere\", \"box\", \"cylinder\", \"mesh\", \"particles\"");
  table.allow_only({"type", "point", "normal"});
  return {table.vec3("point", any("m")), direction(table, "normal")};
}

}  // namespace

std::string shape_file(const TomlTable& shape, const SceneContext& context) {
  const std::filesystem::path file = context.base_dir / shape.text("file");
  const std::string path = std::filesystem::absolute(file).lexically_normal().string();
  if (path.size() > 4096 || one_line(path) != path)
    shape.refuse("file", "not a path that a scene can store",
                 "at most 4096 bytes of printable UTF-8");
  return path;
}

Shape read_shape(const TomlTable& table, ShapeUse use, const SceneContext&) {
  switch (table.choice("type", {"sphere", "box", "cylinder", "half-space"})) {
    case 0: return read_sphere(table);
    case 1: return read_box(table);
    case 2: return read_cylinder(table);
    default: return read_half_space(table, use);
  }
}

}  // namespace firn
