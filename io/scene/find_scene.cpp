// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <numeric>

#include "firn/error.hpp"
#include "io/one_line.hpp"
#include "io/scene/builtin_scenes.hpp"
#include "io/scene/scene_file.hpp"

namespace firn {

namespace {

/// Levenshtein distance: insertions, deletions and substitutions from a to b.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

/// Names that a slip of the pen, or half of the name, could have meant; all
/// names if there is none.
std::string names_like(const std::string& name) {
  std::string near, all;
  const std::string cut = name.substr(0, 200);  // the distance costs |a|·|b|
  for (const BuiltinScene& scene : builtin_scenes()) {
    const bool part = cut.size() >= 3 && scene.name.find(cut) != std::string::npos;
    if (part || edit_distance(cut, scene.name) <= std::max<std::size_t>(2, scene.name.size() / 3))
      near += (near.empty() ? "" : ", ") + scene.name;
    all += (all.empty() ? "" : ", ") + scene.name;
  }
  return near.empty() ? all : near;
}

bool looks_like_path(const std::string& name) {
  const bool toml = name.size() > 5 && name.compare(name.size() - 5, 5, ".toml") == 0;
  return toml || name.find('/') != std::string::npos;
}

}  // namespace

Scene find_scene(const std::string& name_or_path, const SceneOptions& options) {
  if (looks_like_path(name_or_path)) return read_scene_file(name_or_path, options);
  if (const BuiltinScene* scene = find_builtin_scene(name_or_path))
    return parse_scene(scene->toml, "scenes/" + scene->name + ".toml", {}, options);
  std::error_code error;
  if (std::filesystem::exists(name_or_path, error)) return read_scene_file(name_or_path, options);
  throw InputError("scene", "no such file or built-in scene",
                   '"' + one_line(name_or_path, 200) + '"',
                   "a scene file (TOML), or " + names_like(name_or_path));
}

}  // namespace firn
