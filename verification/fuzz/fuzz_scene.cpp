// SPDX-License-Identifier: BSD-3-Clause
// Any text is either a scene whose resolved text reads back as itself, or an
// InputError of one line.

#include <cstddef>
#include <cstdint>
#include <string>

#include "io/scene/scene_file.hpp"
#include "verification/fuzz/judge.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace firn::fuzz;
  const std::string text(data, data + size);
  firn::SceneOptions options;
  options.max_particles = 10000;  // sampling is not what is tested here
  const char* const no_folder = "/nonexistent";
  firn::Scene scene;
  try {
    scene = firn::parse_scene(text, "fuzz.toml", no_folder, options);
  } catch (const firn::InputError& error) {
    require_message(error, "fuzz.toml:");
    return 0;
  }
  try {
    const firn::Scene again = firn::parse_scene(scene.toml, "resolved", no_folder, options);
    require(again.toml == scene.toml, "not a fixed point", scene.toml + again.toml);
  } catch (const firn::InputError& error) {
    require(false, "resolved text refused", scene.toml + error.what());
  }
  return 0;
}
