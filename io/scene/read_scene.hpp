// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The sections of a scene, one function each.

#include <filesystem>
#include <vector>

#include "firn/scene.hpp"
#include "io/scene/scene_file.hpp"
#include "io/scene/toml_table.hpp"

namespace firn {

GridSettings read_grid(const TomlTable& table, double scale);
TimeSettings read_time(const TomlTable& table, double scale);
IntegratorSettings read_integrator(const TomlTable& table);
std::vector<Material> read_materials(const std::vector<TomlTable>& tables);

/// What shapes, bodies and colliders need from the rest of the scene.
struct SceneContext {
  const Scene& scene;  ///< grid and materials are read
  const std::filesystem::path& base_dir;
  const SceneOptions& options;
  std::vector<std::string>& files;  ///< read so far: Scene::files
};

Body read_body(const TomlTable& table, const SceneContext& context);
Collider read_collider(const TomlTable& table, const SceneContext& context);

enum class ShapeUse { body, collider };

/// `file` of a shape: absolute, so that the resolved text means the same file
/// from wherever it is read.
std::string shape_file(const TomlTable& shape, const SceneContext& context);

/// Every shape except `particles`, which is a list of particles, not a shape.
Shape read_shape(const TomlTable& table, ShapeUse use, const SceneContext& context);

}  // namespace firn
