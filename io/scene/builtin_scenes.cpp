// SPDX-License-Identifier: BSD-3-Clause
#include "io/scene/builtin_scenes.hpp"

#include <algorithm>

namespace firn {

namespace {

std::string first_comment(const std::string& toml) {
  const std::string line = toml.substr(0, toml.find('\n'));
  const std::size_t begin = line.find_first_not_of("# ");
  return begin == std::string::npos ? std::string() : line.substr(begin);
}

std::vector<BuiltinScene> read_texts() {
  std::vector<BuiltinScene> scenes;
  for (const BuiltinSceneText& text : builtin_scene_texts())
    scenes.push_back({text.name, first_comment(text.toml), text.toml});
  std::sort(scenes.begin(), scenes.end(),
            [](const BuiltinScene& a, const BuiltinScene& b) { return a.name < b.name; });
  return scenes;
}

}  // namespace

const std::vector<BuiltinScene>& builtin_scenes() {
  static const std::vector<BuiltinScene> scenes = read_texts();
  return scenes;
}

const BuiltinScene* find_builtin_scene(std::string_view name) {
  for (const BuiltinScene& scene : builtin_scenes())
    if (scene.name == name) return &scene;
  return nullptr;
}

}  // namespace firn
