// SPDX-License-Identifier: BSD-3-Clause
/// firn scenes: the built-in scenes.

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "cli/verbs.hpp"
#include "firn/error.hpp"
#include "io/scene/builtin_scenes.hpp"

namespace firn::cli {

namespace {

void list_scenes(bool json) {
  if (json) {
    nlohmann::json list = nlohmann::json::array();
    for (const BuiltinScene& scene : builtin_scenes())
      list.push_back({{"name", scene.name}, {"description", scene.description}});
    fmt::print("{}\n", list.dump(2));
    return;
  }
  for (const BuiltinScene& scene : builtin_scenes())
    fmt::print("{:<18} {}\n", scene.name, scene.description);
}

void show_scene(const std::string& name) {
  const BuiltinScene* scene = find_builtin_scene(name);
  if (scene == nullptr)
    throw InputError("--show", "unknown built-in scene", name, "a name that `firn scenes` prints");
  fmt::print("{}", scene->toml);
}

}  // namespace

void add_scenes(CLI::App& app, Context&) {
  CLI::App* verb =
      app.add_subcommand("scenes", "lists the built-in scenes, one per line, name first");
  auto json = std::make_shared<bool>(false);
  auto show = std::make_shared<std::string>();
  verb->add_flag("--json", *json, "print JSON");
  verb->add_option("--show", *show, "print the TOML text of this scene instead");
  verb->callback([json, show] { show->empty() ? list_scenes(*json) : show_scene(*show); });
}

}  // namespace firn::cli
