// SPDX-License-Identifier: BSD-3-Clause
#include "io/scene/scene_file.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <system_error>

#include "firn/memory.hpp"
#include "io/scene/read_scene.hpp"

namespace firn {

namespace {

constexpr std::size_t longest_file = 16 << 20;  // bytes
constexpr std::ptrdiff_t most_dots = 64;        // in a line

std::string_view line_of(std::string_view text, std::size_t number) {
  for (; number > 1; --number) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  text = text.substr(0, text.find('\n'));
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == std::string_view::npos ? std::string_view{} : text.substr(first);
}

/// The TOML library recurses once per part of a dotted key, so that a key
/// a.a.a… of 1e5 parts overflows the stack. Our own keys have three parts.
void guard_against_deep_keys(std::string_view text, const std::string& file_name) {
  std::size_t number = 1;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    const std::ptrdiff_t dots = std::count(line.begin(), line.end(), '.');
    const std::size_t first = line.find_first_not_of(" \t");
    const bool comment = first != std::string_view::npos && line[first] == '#' &&
                         line.find_first_of("\"'") == std::string_view::npos;
    if (dots > most_dots && !comment)
      throw InputError(file_name + ":" + std::to_string(number), "too many dots in one line",
                       std::to_string(dots), "at most " + std::to_string(most_dots));
  }
}

toml::table parse_toml(std::string_view text, const std::string& file_name) {
  guard_against_deep_keys(text, file_name);
  try {
    return toml::parse(text, std::string_view(file_name));
  } catch (const toml::parse_error& error) {
    const std::size_t number = std::max<std::size_t>(1, error.source().begin.line);
    throw InputError(file_name + ":" + std::to_string(number),
                     "not TOML: " + one_line(error.description(), 200),
                     "`" + one_line(line_of(text, number), 60) + "`", "TOML 1.0");
  }
}

std::string about(double count) {
  std::ostringstream text;
  text << "about " << std::setprecision(3) << count;
  return text.str();
}

/// Upper bound of a body's particles, from the cells that its bounding box touches.
double most_particles(const Body& body, double h) {
  if (body.sampling == Sampling::from_file) return static_cast<double>(body.particles.size());
  const Bounds box = *bounds(body.shape);
  return (((box.max - box.min) / h).array() + 2).prod() * body.particles_per_cell;
}

/// Samples the body alone: nothing less tells for sure whether a thin body
/// catches any point.
std::size_t count_particles(const TomlTable& table, const Scene& scene, const Body& body) {
  Scene alone;
  alone.grid = scene.grid;
  alone.materials = scene.materials;
  alone.bodies = {body};
  try {
    return sample_bodies(alone).size();
  } catch (const InputError& error) {
    throw InputError(table.where() + ": " + error.what());
  }
}

void read_bodies(const TomlTable& root, const SceneContext& context, Scene& scene) {
  double particles = 0, expected = 0;
  const double bytes = context.options.bytes_per_particle * (scene.semi_implicit() ? 1.5 : 1);
  const auto limit = static_cast<double>(context.options.max_particles);
  for (const TomlTable& table : root.tables("body")) {
    Body body = read_body(table, context);
    particles += most_particles(body, scene.grid.spacing);
    if (!(particles <= limit))
      throw InputError(table.where(), "too many particles", about(particles),
                       "at most " + to_text(limit) + ", counted in bounding boxes");
    if (bytes > 0) {
      expected += expected_particles(scene.grid, body);
      require_memory(table.where(), expected, bytes);
    }
    if (count_particles(table, scene, body) == 0)
      throw InputError(table.where(), "body without particles", "0",
                       "a shape that holds at least one sampling point");
    scene.bodies.push_back(std::move(body));
  }
  if (scene.bodies.empty() && context.options.needs_bodies)
    root.refuse("body", "missing", "at least one [[body]]");
}

void check_scale(double scale) {
  const Range allowed = closed(0.01, 100);
  if (!allowed.holds(scale))
    throw InputError("scale", "refinement out of range", to_text(scale), allowed.text());
}

}  // namespace

Scene parse_scene(std::string_view text, const std::string& file_name,
                  const std::filesystem::path& base_dir, const SceneOptions& options) {
  check_scale(options.scale);
  const std::string shown_name = one_line(file_name);
  const toml::table document = parse_toml(text, shown_name);
  const TomlTable root(document, shown_name);
  root.allow_only({"name", "gravity", "grid", "time", "integrator", "transfer", "material", "body",
                   "collider"});
  Scene scene;
  scene.name = root.text("name");
  scene.gravity = root.vec3_or("gravity", any("m/s^2"), Vec3::Zero());
  scene.grid = read_grid(root.table("grid"), options.scale);
  scene.time = read_time(root.table("time"), options.scale);
  scene.integrator = read_integrator(root.table("integrator"));
  const TomlTable transfer = root.table("transfer");
  transfer.allow_only({"flip"});
  scene.flip = transfer.number("flip", closed(0, 1));
  scene.materials = read_materials(root.tables("material"));
  if (scene.materials.empty()) root.refuse("material", "missing", "at least one [[material]]");
  std::vector<std::string> files;
  const SceneContext context = {scene, base_dir, options, files};
  read_bodies(root, context, scene);
  for (const TomlTable& table : root.tables("collider"))
    scene.colliders.push_back(read_collider(table, context));
  scene.toml = resolved_toml(scene);
  scene.files = std::move(files);
  return scene;
}

Scene read_scene_file(const std::filesystem::path& path, const SceneOptions& options) {
  const std::string name = one_line(path.string());
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    throw InputError(name, "cannot be read", "no such file", "a scene file (TOML)");
  if (std::filesystem::is_directory(status))
    throw InputError(name, "cannot be read", "a directory", "a scene file (TOML)");
  std::ifstream file(path, std::ios::binary);
  std::string text(longest_file + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file.is_open() || file.bad())
    throw InputError(name, "cannot be read", "an unreadable file", "a scene file (TOML)");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > longest_file)
    throw InputError(name, "too long", "more than " + std::to_string(longest_file) + " bytes",
                     "a scene file (TOML) of at most " + std::to_string(longest_file) + " bytes");
  Scene scene = parse_scene(text, path.string(), path.parent_path(), options);
  scene.files.push_back(path.string());
  return scene;
}

}  // namespace firn
