// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The scenes of scenes/*.toml, built into the program.

#include <string>
#include <string_view>
#include <vector>

namespace firn {

struct BuiltinScene {
  std::string name;         ///< the file's name without ".toml"
  std::string description;  ///< the file's first line, a comment
  std::string toml;         ///< the whole text
};

/// Sorted by name.
const std::vector<BuiltinScene>& builtin_scenes();

/// Null if there is none of that name.
const BuiltinScene* find_builtin_scene(std::string_view name);

/// Name and text, as the build embedded them.
struct BuiltinSceneText {
  const char* name;
  const char* toml;
};
const std::vector<BuiltinSceneText>& builtin_scene_texts();

}  // namespace firn
