// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/parse_obj.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "firn/error.hpp"
#include "io/mesh/mesh_text.hpp"
#include "io/mesh/polygon.hpp"

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
    skip_byte_order_mark(text_, where_);
    while (!text_.empty()) {
      std::string joined;
      read_statement(take_statement(joined));
    }
    weld(mesh_);
    return std::move(mesh_);
  }

 private:
  std::string here() const { return where_ + ":" + std::to_string(line_); }

  /// The next line without its comment. A backslash in a comment joins no lines.
  std::string_view next_line(bool& continued) {
    ++line_;
    const std::string_view line = take_line(text_);
    std::string_view statement = line.substr(0, line.find('#'));
    continued = statement.size() == line.size() && !line.empty() && line.back() == '\\';
    if (continued) statement.remove_suffix(1);
    return statement;
  }

  /// One line, with those that a backslash at the end joins to it.
  std::string_view take_statement(std::string& joined) {
    bool continued = false;
    const std::string_view line = next_line(continued);
    if (!continued) return line;
    joined = line;
    while (continued) {
      joined += ' ';
      joined += next_line(continued);
    }
    return joined;
  }

  void read_statement(std::string_view statement) {
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
    corners_.clear();
    for (std::string_view word = take_word(words); !word.empty(); word = take_word(words))
      corners_.push_back(vertex_index(word));
    if (corners_.size() < 3)
      throw InputError(here(), "corners of a face", std::to_string(corners_.size()), "at least 3");
    if (corners_.size() > largest_number_of_triangles - mesh_.triangles.size())
      throw InputError(here(), "triangles", "more",
                       "at most " + std::to_string(largest_number_of_triangles));
    if (!append_polygon(mesh_.vertices, corners_, mesh_.triangles))
      throw InputError(
          here(), "face",
          "a polygon of " + std::to_string(corners_.size()) + " corners that crosses itself",
          "polygons that do not");
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
                       count == 0 ? "none, as no vertex stands above"
                                  : "1 to " + std::to_string(count) + " or -" +
                                        std::to_string(count) + " to -1 (the vertices above)");
    return static_cast<std::int32_t>(index > 0 ? index - 1 : count + index);
  }

  std::string_view text_;
  const std::string& where_;
  std::int64_t line_ = 0;
  TriangleMesh mesh_;
  std::vector<std::int32_t> corners_;  // of the face being read
};

}  // namespace

TriangleMesh parse_obj(std::string_view text, const std::string& where) {
  return ObjReader(text, where).read();
}

}  // namespace firn
