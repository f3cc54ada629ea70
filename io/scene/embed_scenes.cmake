# SPDX-License-Identifier: BSD-3-Clause
# Writes OUTPUT, a C++ file that holds the text of every file in SCENES.
set(code "// Generated from scenes/*.toml by embed_scenes.cmake.\n")
string(APPEND code "#include \"io/scene/builtin_scenes.hpp\"\n\nnamespace firn {\n\n")
string(APPEND code "const std::vector<BuiltinSceneText>& builtin_scene_texts() {\n")
string(APPEND code "  static const std::vector<BuiltinSceneText> texts = {\n")
foreach(file IN LISTS SCENES)
  get_filename_component(name ${file} NAME_WE)
  file(READ ${file} text)
  string(APPEND code "      {\"${name}\", R\"firn_toml(${text})firn_toml\"},\n")
endforeach()
string(APPEND code "  };\n  return texts;\n}\n\n}  // namespace firn\n")
file(WRITE ${OUTPUT} "${code}")
