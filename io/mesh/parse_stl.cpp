// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/parse_stl.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "firn/error.hpp"
#include "io/mesh/mesh_text.hpp"

namespace firn {

namespace {

void require_room(std::size_t triangles, const std::string& where) {
  if (triangles > largest_number_of_triangles)
    throw InputError(where, "triangles", std::to_string(triangles),
                     "at most " + std::to_string(largest_number_of_triangles));
}

void append_triangle(TriangleMesh& mesh) {
  const auto end = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.triangles.push_back({end - 3, end - 2, end - 1});
}

// Binary: 80 bytes of anything, a count, then 50 bytes a triangle: a normal,
// three corners, all float, and two bytes of anything.

constexpr std::size_t header_size = 84, triangle_size = 50;

std::uint32_t little_endian(const char* bytes) {
  std::uint32_t value = 0;
  for (int byte = 3; byte >= 0; --byte)
    value = value << 8 | static_cast<unsigned char>(bytes[byte]);
  return value;
}

float float_at(const char* bytes) {
  const std::uint32_t bits = little_endian(bytes);
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

std::size_t stated_size(std::string_view bytes) {
  return header_size + triangle_size * std::size_t{little_endian(&bytes[80])};
}

/// A file of the size that its count asks for is binary, whatever its first word. Otherwise it
/// is text if it begins so: counts below 16 million end in a byte 0.
bool is_binary(std::string_view bytes) {
  if (bytes.size() >= header_size && bytes.size() == stated_size(bytes)) return true;
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff")) return false;  // UTF-16
  constexpr std::string_view space = "\t\n\v\f\r";
  return std::any_of(
      bytes.begin(), bytes.begin() + std::min(bytes.size(), header_size), [&](char c) {
        return (static_cast<unsigned char>(c) < ' ' && space.find(c) == space.npos) || c == '\x7f';
      });
}

TriangleMesh parse_binary(std::string_view bytes, const std::string& where) {
  if (bytes.size() < header_size)
    throw InputError(where, "bytes of a binary STL", std::to_string(bytes.size()),
                     "at least " + std::to_string(header_size) + ", its header");
  const std::size_t count = little_endian(&bytes[80]);
  if (bytes.size() != stated_size(bytes))
    throw InputError(where, "bytes of a binary STL", std::to_string(bytes.size()),
                     std::to_string(stated_size(bytes)) + ", for the " + std::to_string(count) +
                         " triangles that it counts");
  require_room(count, where);
  TriangleMesh mesh;
  mesh.vertices.reserve(3 * count);
  mesh.triangles.reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    const char* corners = &bytes[header_size + triangle_size * t + 12];
    for (int corner = 0; corner < 3; ++corner) {
      Vec3 x;
      for (int axis = 0; axis < 3; ++axis) x[axis] = float_at(corners + 12 * corner + 4 * axis);
      for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(x[axis]) <= largest_coordinate))
          throw InputError(where, "coordinate in triangle " + std::to_string(t), to_text(x[axis]),
                           "numbers from -" + to_text(largest_coordinate) + " to " +
                               to_text(largest_coordinate));
      mesh.vertices.push_back(x);
    }
    append_triangle(mesh);
  }
  return mesh;
}

// Text: solid NAME { facet normal x y z outer loop (vertex x y z)×3 endloop
// endfacet } endsolid NAME, in upper or lower case.

class AsciiReader {
 public:
  AsciiReader(std::string_view text, const std::string& where) : text_(text), where_(where) {}

  TriangleMesh read() {
    skip_byte_order_mark(text_, where_);
    while (!next_line().empty()) read_solid();
    return std::move(mesh_);
  }

 private:
  /// The next line with a word in it, in lower case; empty at the end.
  const std::string& next_line() {
    statement_.clear();
    while (statement_.empty() && !text_.empty()) {
      std::string_view line = take_line(text_);
      ++line_;
      for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
        if (!statement_.empty()) statement_ += ' ';
        statement_ += word;
      }
    }
    for (char& c : statement_)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return statement_;
  }

  std::string here() const { return where_ + ":" + std::to_string(line_); }

  bool begins(std::string_view keyword) const {
    return std::string_view(statement_).substr(0, keyword.size()) == keyword &&
           (statement_.size() == keyword.size() || statement_[keyword.size()] == ' ');
  }

  void require(std::string_view keyword) const {
    if (!begins(keyword))
      throw InputError(here(), "line",
                       statement_.empty() ? "the end of the file" : quoted(statement_),
                       "\"" + std::string(keyword) + "\"");
  }

  void read_solid() {
    require("solid");
    while (next_line(), !begins("endsolid")) read_facet();
  }

  void read_facet() {
    require("facet");
    next_line();
    require("outer loop");
    for (int corner = 0; corner < 3; ++corner) {
      next_line();
      require("vertex");
      std::string_view words = std::string_view(statement_).substr(6);
      Vec3 x;
      for (int axis = 0; axis < 3; ++axis) x[axis] = to_coordinate(take_word(words), here());
      mesh_.vertices.push_back(x);
    }
    append_triangle(mesh_);
    require_room(mesh_.triangles.size(), here());
    next_line();
    require("endloop");
    next_line();
    require("endfacet");
  }

  std::string_view text_;
  const std::string& where_;
  std::int64_t line_ = 0;
  std::string statement_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh parse_stl(std::string_view bytes, const std::string& where) {
  TriangleMesh mesh =
      is_binary(bytes) ? parse_binary(bytes, where) : AsciiReader(bytes, where).read();
  weld(mesh);
  return mesh;
}

}  // namespace firn
