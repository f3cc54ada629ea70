// SPDX-License-Identifier: BSD-3-Clause
// docs/error_messages.md lists the cases. Each must end in an InputError with exactly the message
// listed there; the program, given the same input, must print that one line, end with status 2
// and write nothing. FIRN_UPDATE_DOCS=1 writes the current messages into the list: read the diff.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <sstream>

#include "firn/error.hpp"
#include "io/mesh/mesh_shape.hpp"
#include "io/scene/scene_file.hpp"
#include "io/trajectory/writer.hpp"
#include "verification/support/program.hpp"
#include "verification/support/temporary_folder.hpp"

namespace firn {
namespace {

using fixtures::Outcome;
using fixtures::run_firn;
using fixtures::TemporaryFolder;

const std::filesystem::path document = FIRN_SOURCE_DIR "/docs/error_messages.md";

std::vector<std::string> read_lines(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// The cells of "| a | b | c |", without the backticks of code.
std::vector<std::string> cells(const std::string& row) {
  std::vector<std::string> cells;
  std::string cell;
  std::istringstream in(row.substr(1));
  while (std::getline(in, cell, '|')) {
    const std::size_t first = cell.find_first_not_of(" `"), last = cell.find_last_not_of(" `");
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

/// \n, \\ and \xHH as they stand in the table.
std::string unescaped(const std::string& cell) {
  std::string text;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    if (cell[i] != '\\' || i + 1 == cell.size()) {
      text += cell[i];
    } else if (cell[++i] == 'n') {
      text += '\n';
    } else if (cell[i] == 'x') {
      text += static_cast<char>(std::stoi(cell.substr(i + 1, 2), nullptr, 16));
      i += 2;
    } else {
      text += cell[i];
    }
  }
  return text;
}

/// Visits the rows of the table under a heading; `visit` gives the message,
/// which must be the last cell. Returns the number of cases.
int check_table(const std::string& heading,
                const std::function<std::string(const std::vector<std::string>&)>& visit) {
  std::vector<std::string> lines = read_lines(document);
  const bool update = std::getenv("FIRN_UPDATE_DOCS") != nullptr;
  bool here = false;
  int cases = 0;
  for (std::string& line : lines) {
    if (line.rfind("## ", 0) == 0) here = line == heading;
    if (!here || line.rfind("| ", 0) != 0 || line.rfind("the message |") != std::string::npos)
      continue;
    SCOPED_TRACE(line);
    const std::vector<std::string> row = cells(line);
    const std::string message = visit(row);
    EXPECT_EQ(message.find_first_of("\n\r"), std::string::npos) << "one line";
    ++cases;
    if (update) {
      const std::size_t last = line.rfind('|', line.size() - 2);
      line = line.substr(0, last) + "| ``" + message + "`` |";
    } else {
      EXPECT_EQ(message, row.back());
    }
  }
  if (update) {
    std::ofstream file(document);
    for (const std::string& line : lines) file << line << '\n';
  }
  return cases;
}

std::string message_of(const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "read without complaint";
  return {};
}

/// Everything below `folder`, with sizes.
std::map<std::string, std::uintmax_t> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::uintmax_t> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    files[entry.path().string()] = entry.is_regular_file() ? entry.file_size() : 0;
  return files;
}

/// The program says the same, and nothing but that: `firn run` and `firn check` in turn.
void expect_from_program(const std::filesystem::path& folder, const std::vector<std::string>& scene,
                         const std::string& message) {
  const auto before = contents(folder);
  static bool check = false;
  check = !check;
  std::vector<std::string> words = {check ? "check" : "run"};
  words.insert(words.end(), scene.begin(), scene.end());
  const Outcome outcome = run_firn(words, folder);
  EXPECT_EQ(outcome.status, 2) << words[0];
  EXPECT_EQ(outcome.out, "") << words[0];
  EXPECT_EQ(outcome.err, "firn: " + message + "\n") << words[0];
  EXPECT_EQ(contents(folder), before) << "something was written";
}

/// The scene in the document's code block.
std::string good_scene() {
  std::string scene;
  bool inside = false;
  for (const std::string& line : read_lines(document)) {
    if (line == "```" && inside) break;
    if (inside) scene += line + "\n";
    if (line == "```toml") inside = true;
  }
  return scene;
}

TEST(BadInput, TheSceneOfTheDocumentIsGood) {
  EXPECT_NO_THROW(parse_scene(good_scene(), "scene.toml", {}));
}

TEST(BadInput, Scenes) {
  const std::string good = good_scene();
  const TemporaryFolder folder;
  const int cases = check_table("## Scenes", [&](const std::vector<std::string>& row) {
    const std::string from = unescaped(row.at(0)), to = unescaped(row.at(1));
    const std::size_t at = good.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    EXPECT_EQ(good.find(from, at + 1), std::string::npos) << "twice in the scene: " << from;
    std::string bad = good;
    bad.replace(at, from.size(), to);
    const std::string message = message_of([&] { parse_scene(bad, "scene.toml", {}); });
    std::ofstream(folder.path() / "scene.toml", std::ios::binary) << bad;
    expect_from_program(folder.path(), {"scene.toml"}, message);
    EXPECT_EQ(message.rfind("scene.toml:", 0), 0u) << "file:line first";
    EXPECT_NE(message.find(": got "), std::string::npos);
    EXPECT_NE(message.find(", allowed: "), std::string::npos);
    return message;
  });
  EXPECT_GE(cases, 80);
}

void write(const std::string& name, const std::string& text) {
  std::ofstream(name, std::ios::binary) << text;
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

/// Paths in messages are absolute; in the document they are not.
std::string without(std::string text, const std::string& part) {
  for (std::size_t at; (at = text.find(part)) != std::string::npos;) text.erase(at, part.size());
  return text;
}

void write_trajectory(const std::string& name, int frames) {
  const Scene scene = find_scene("two_particles");
  const State state = initial_state(scene);
  TrajectoryWriter writer(name, {"nobody", Precision::float64, 1, "0", "none", ""},
                          static_cast<std::int64_t>(state.particles.size()), 0, frames, 0);
  for (int frame = 0; frame < frames; ++frame) writer.write_frame(state, {});
  writer.finish();
}

/// What is read, as a user names it; with `text`, that is what scene.toml holds.
struct Case {
  std::string scene = "scene.toml";
  std::string text = {};
  double scale = 1;

  Scene read(const std::filesystem::path& folder) const {
    SceneOptions options;
    options.scale = scale;
    return text.empty() ? find_scene(scene, options) : parse_scene(text, scene, folder, options);
  }
};

/// Bodies of particles, from files good and bad.
std::map<std::string, Case> particle_cases(const std::filesystem::path& folder) {
  write("text.vtkhdf", "no HDF5\n");
  write_trajectory("good.vtkhdf", 1);
  std::filesystem::copy_file("good.vtkhdf", "cut.vtkhdf",
                             std::filesystem::copy_options::overwrite_existing);
  std::filesystem::resize_file("cut.vtkhdf", std::filesystem::file_size("good.vtkhdf") / 2);

  const auto read = [](const std::string& file, const std::string& more = "", double scale = 1) {
    std::string bad = good_scene();
    const std::size_t shape = bad.find("shape = {"), end = bad.find("[[collider]]");
    bad.replace(shape, end - shape,
                "shape = { type = \"particles\", file = \"" + file + "\" }\n" + more);
    return Case{"scene.toml", bad, scale};
  };
  EXPECT_NO_THROW(read("good.vtkhdf").read(folder)) << "or the cases below prove nothing";
  return {
      {"a body of particles, missing file", read("missing.vtkhdf")},
      {"a body of particles, a directory", read("folder.toml")},
      {"a body of particles, a text file", read("text.vtkhdf")},
      {"a body of particles, a trajectory cut off in the middle", read("cut.vtkhdf")},
      {"a body of particles with a seed", read("good.vtkhdf", "seed = 1\n")},
      {"a body of particles that spins", read("good.vtkhdf", "angular_velocity = [0, 0, 1]\n")},
      {"a body of particles, refined", read("good.vtkhdf", "", 2)},
      {"a collider of particles",
       read("good.vtkhdf", "[[collider]]\nsticky = true\nshape = { type = \"particles\" }\n")},
  };
}

/// Colliders and bodies from mesh and level-set files.
std::map<std::string, Case> mesh_cases(const std::filesystem::path& folder) {
  // A tetrahedron, of which `faces` triangles are there.
  const auto tetrahedron = [](int faces) {
    std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    const char* const face[] = {"f 1 3 2\n", "f 1 2 4\n", "f 2 3 4\n", "f 3 1 4\n"};
    for (int i = 0; i < faces; ++i) text += face[i];
    return text;
  };
  write("mesh.ply", tetrahedron(4));
  write("closed.obj", tetrahedron(4));
  write("open.obj", tetrahedron(3));
  write("wrong.obj", tetrahedron(3) + "f 3 1 5\n");
  write("text.vdb", "no OpenVDB\n");

  const auto shape = [](const std::string& shape, const char* section = "[[collider]]") {
    std::string bad = good_scene();
    const std::size_t begin = bad.find("shape = {", bad.find(section));
    bad.replace(begin, bad.find('\n', begin) - begin, "shape = { " + shape + " }");
    return Case{"scene.toml", bad};
  };
  if (has_openvdb()) {
    EXPECT_NO_THROW(shape("type = \"mesh\", file = \"closed.obj\"").read(folder))
        << "or the cases below prove nothing";
  }
  return {
      {"a mesh, missing file", shape("type = \"mesh\", file = \"missing.obj\"")},
      {"a mesh, a directory", shape("type = \"mesh\", file = \"folder.toml\"")},
      {"a mesh of unknown format", shape("type = \"mesh\", file = \"mesh.ply\"")},
      {"a mesh, not closed", shape("type = \"mesh\", file = \"open.obj\"")},
      {"a mesh, a vertex that does not exist", shape("type = \"mesh\", file = \"wrong.obj\"")},
      {"a mesh, scaled beyond any grid",
       shape("type = \"mesh\", file = \"closed.obj\", scale = 1e9")},
      {"a mesh, scale 0", shape("type = \"mesh\", file = \"closed.obj\", scale = 0")},
      {"a level set, text", shape("type = \"level-set\", file = \"text.vdb\"")},
      {"a level set, as a body", shape("type = \"level-set\", file = \"text.vdb\"", "[[body]]")},
  };
}

TEST(BadInput, Files) {
  const fixtures::TemporaryFolder temporary;
  const auto& folder = temporary.path();
  std::filesystem::create_directories(folder / "folder.toml");
  std::filesystem::current_path(folder);
  write("empty.toml", "");
  write("trajectory.toml", std::string("\x89HDF\r\n\x1a\n\0\0\0\0\0\x08\x08\0", 16));
  write("blank.toml", std::string(std::size_t{17} << 20, ' '));
  write("nested.toml", "a = " + repeated("[", 300));
  write("deep.toml", repeated("a.", 69) + "a = 1");

  std::map<std::string, Case> cases = {
      {"a missing file", {"missing.toml"}},
      {"a directory", {"folder.toml"}},
      {"an empty file", {"empty.toml"}},
      {"a trajectory instead of a scene", {"trajectory.toml"}},
      {"17 MiB of blanks", {"blank.toml"}},
      {"arrays nested 300 deep", {"nested.toml"}},
      {"a key of 70 parts", {"deep.toml"}},
      {"a name similar to a built-in scene", {"snowball_dorp"}},
      {"a name unlike any scene", {"quicksilver"}},
  };
  cases.merge(particle_cases(folder));
  cases.merge(mesh_cases(folder));
  const int checked = check_table("## Files", [&](const std::vector<std::string>& row) {
    if (row.at(0) == "a level set, text" && !has_openvdb()) return row.back();
    const Case& bad = cases.at(row.at(0));
    const std::string message = message_of([&] { bad.read(folder); });
    if (!bad.text.empty()) write("scene.toml", bad.text);
    expect_from_program(folder, {bad.scene, "--scale", to_text(bad.scale)}, message);
    return without(message, folder.string() + "/");
  });
  EXPECT_EQ(checked, static_cast<int>(cases.size()));
}

}  // namespace
}  // namespace firn
