// SPDX-License-Identifier: BSD-3-Clause
#include <fstream>
#include <limits>

#include "firn/error.hpp"
#include "io/mesh/mesh_shape.hpp"
#include "io/mesh/parse_obj.hpp"
#include "io/mesh/parse_stl.hpp"

namespace firn {

namespace {

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file ? std::streamoff(file.tellg()) : -1;
  constexpr std::streamoff largest = std::streamoff(1) << 32;
  if (size < 0 || size > largest)  // a directory opens, too, and tells an absurd size
    throw InputError(path, "file", size < 0 ? "one that cannot be opened" : to_text(double(size)),
                     "a readable file of at most 4294967296 bytes");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  file.seekg(0);
  if (!file.read(bytes.data(), size))
    throw InputError(path, "file", "an error while reading", "a readable file");
  return bytes;
}

std::string extension(const std::string& path) {
  const std::size_t dot = path.find_last_of("./\\");
  std::string text = dot == std::string::npos || path[dot] != '.' ? "" : path.substr(dot);
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

}  // namespace

TriangleMesh read_mesh(const std::string& path) {
  const std::string type = extension(path);
  if (type != ".obj" && type != ".stl")
    throw InputError(path, "kind of mesh file", "\"" + type + "\"", ".obj or .stl");
  TriangleMesh mesh =
      type == ".obj" ? parse_obj(read_file(path), path) : parse_stl(read_file(path), path);
  if (!is_closed(mesh) && !mesh.vertices.empty()) {
    // Exporters compute a corner once for every triangle and round each time.
    const Bounds b = bounds(mesh);
    weld(mesh, std::numeric_limits<float>::epsilon() * (b.max - b.min).maxCoeff());
  }
  require_closed(mesh, path);
  return mesh;
}

}  // namespace firn
