// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/mesh_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "firn/error.hpp"
#include "io/mesh/triangle_mesh.hpp"

namespace firn {

void skip_byte_order_mark(std::string_view& text, const std::string& where) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw InputError(where, "encoding", "UTF-16", "ASCII or UTF-8");
}

std::string_view take_word(std::string_view& text) {
  constexpr std::string_view space = " \t\r\n\v\f";
  text.remove_prefix(std::min(text.find_first_not_of(space), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(space));
  text.remove_prefix(word.size());
  return word;
}

std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

double to_coordinate(std::string_view word, const std::string& where) {
  if (word.empty()) throw InputError(where, "coordinate", "none", "three, x, y and z");
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole = error == std::errc() && end == digits.data() + digits.size();
  if (!whole || !(std::abs(value) <= largest_coordinate))
    throw InputError(
        where, "coordinate", quoted(word),
        "numbers from -" + to_text(largest_coordinate) + " to " + to_text(largest_coordinate));
  return value;
}

std::string quoted(std::string_view word, std::size_t longest) {
  std::string text = "\"";
  for (const char c : word.substr(0, longest)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > longest ? "…\"" : "\"");
}

}  // namespace firn
