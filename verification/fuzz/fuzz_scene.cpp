// Any text is either a scene whose resolved text reads back as itself, or an
// InputError of one line.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "firn/error.hpp"
#include "io/scene/scene_file.hpp"

namespace {

void require(bool holds, const char* what, const std::string& text) {
  if (holds) return;
  std::fprintf(stderr, "%s:\n%s\n", what, text.c_str());
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  firn::SceneOptions options;
  options.max_particles = 10000;  // sampling is not what is tested here
  const char* const no_folder = "/nonexistent";
  firn::Scene scene;
  try {
    scene = firn::parse_scene(text, "fuzz.toml", no_folder, options);
  } catch (const firn::InputError& error) {
    const std::string message = error.what();
    require(message.find_first_of("\n\r\t\0\x7f") == std::string::npos, "more than a line",
            message);
    require(message.rfind("fuzz.toml:", 0) == 0, "no file and line", message);
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
