// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/parse_obj.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "firn/error.hpp"
#include "io/mesh/mesh_text.hpp"

namespace firn {

namespace {

// Statements that add no surface.
constexpr std::array<std::string_view, 20> passed_over = {
    "vt",  "vn",       "vp",       "p",          "l",         "o",      "g",
    "s",   "mg",       "usemtl",   "mtllib",     "usemap",    "maplib", "bevel",
    "lod", "c_interp", "d_interp", "shadow_obj", "trace_obj", "call"};

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& where) : text_(text), where_(where) {}

  TriangleMesh read() {
    while (!text_.empty()) {
      std::string joined;
      read_statement(take_statement(joined));
    }
    weld(mesh_);
    return std::move(mesh_);
  }

 private:
  std::string here() const { return where_ + ":" + std::to_string(line_); }

  /// One line, with those that a backslash at the end joins to it.
  std::string_view take_statement(std::string& joined) {
    std::string_view line = take_line(text_);
    ++line_;
    if (line.empty() || line.back() != '\\') return line;
    while (!line.empty() && line.back() == '\\') {
      line.remove_suffix(1);
      joined += line;
      joined += ' ';
      line = take_line(text_);
      ++line_;
    }
    return joined += line;
  }

  void read_statement(std::string_view statement) {
    statement = statement.substr(0, statement.find('#'));
    const std::string_view keyword = take_word(statement);
    if (keyword.empty()) return;
    if (keyword == "v")
      read_vertex(statement);
    else if (keyword == "f")
      read_face(statement);
    else if (std::find(passed_over.begin(), passed_over.end(), keyword) == passed_over.end())
      throw InputError(here(), "statement", quoted(keyword),
                       "v, f, and statements that define no surface");
  }

  /// v x y z, then perhaps a weight or a colour.
  void read_vertex(std::string_view words) {
    if (mesh_.vertices.size() >= 3 * largest_number_of_triangles)
      throw InputError(here(), "vertices", "more",
                       "at most " + std::to_string(3 * largest_number_of_triangles));
    Vec3 x;
    for (int axis = 0; axis < 3; ++axis) x[axis] = to_coordinate(take_word(words), here());
    mesh_.vertices.push_back(x);
  }

  /// f a b c …, each a vertex, or vertex/texture/normal.
  void read_face(std::string_view words) {
    const std::int32_t first = vertex_index(take_word(words));
    std::int32_t previous = vertex_index(take_word(words));
    std::string_view word = take_word(words);
    do {
      const std::int32_t corner = vertex_index(word);
      if (mesh_.triangles.size() >= largest_number_of_triangles)
        throw InputError(here(), "triangles", "more",
                         "at most " + std::to_string(largest_number_of_triangles));
      mesh_.triangles.push_back({first, previous, corner});
      previous = corner;
      word = take_word(words);
    } while (!word.empty());
  }

  /// 1 is the first vertex, −1 the one read last.
  std::int32_t vertex_index(std::string_view word) {
    const std::string_view digits = word.substr(0, word.find('/'));
    const auto count = static_cast<std::int64_t>(mesh_.vertices.size());
    std::int64_t index = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
    const bool whole = error == std::errc() && end == digits.data() + digits.size();
    if (!whole || index == 0 || index > count || index < -count)
      throw InputError(here(), "vertex of a face", quoted(word),
                       "1 to " + std::to_string(count) + " or -" + std::to_string(count) +
                           " to -1 (the vertices above), at least 3 per face");
    return static_cast<std::int32_t>(index > 0 ? index - 1 : count + index);
  }

  std::string_view text_;
  const std::string& where_;
  std::int64_t line_ = 0;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh parse_obj(std::string_view text, const std::string& where) {
  return ObjReader(text, where).read();
}

}  // namespace firn
