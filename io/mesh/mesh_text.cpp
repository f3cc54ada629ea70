// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh/mesh_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "firn/error.hpp"
#include "io/mesh/triangle_mesh.hpp"

namespace firn {

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

std::string quoted(std::string_view word) {
  constexpr std::size_t longest = 32;
  std::string text = "\"";
  for (const char c : word.substr(0, longest)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > longest ? "…\"" : "\"");
}

}  // namespace firn
