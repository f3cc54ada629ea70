// SPDX-License-Identifier: BSD-3-Clause
#include "io/one_line.hpp"

#include <algorithm>
#include <cstdio>

namespace firn {

namespace {

/// Bytes of the valid UTF-8 sequence at `text[at]`, 0 if there is none.
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  const std::size_t length = first < 0x80             ? 1
                             : (first & 0xE0) == 0xC0 ? 2
                             : (first & 0xF0) == 0xE0 ? 3
                             : (first & 0xF8) == 0xF0 ? 4
                                                      : 0;
  if (length == 0 || at + length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(at + i) & 0xC0) != 0x80) return 0;
  // Longer than need be, surrogates, beyond U+10FFFF: no decoder takes these.
  if (first == 0xC0 || first == 0xC1 || first > 0xF4) return 0;
  const unsigned char second = length > 1 ? byte(at + 1) : 0;
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
      (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F))
    return 0;
  return length;
}

/// Does a terminal or a reader of lines take this character for more than a glyph?
bool breaks_line(std::string_view glyph) {
  if (glyph.size() == 1) return static_cast<unsigned char>(glyph[0]) < 0x20 || glyph[0] == 0x7F;
  return (glyph.size() == 2 && glyph[0] == '\xC2' && (glyph[1] & 0xE0) == 0x80) ||  // C1 controls
         glyph == "\xE2\x80\xA8" || glyph == "\xE2\x80\xA9";  // line, paragraph separator
}

}  // namespace

std::string one_line(std::string_view text, std::size_t longest) {
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const std::string_view glyph = text.substr(at, std::max<std::size_t>(1, length));
    if (longest != 0 && line.size() + glyph.size() > longest) return line + "...";
    if (length == 0 || breaks_line(glyph)) {
      for (const char c : glyph) {
        char code[5];
        std::snprintf(code, sizeof code, "\\x%02X", static_cast<unsigned char>(c));
        line += code;
      }
    } else {
      line += glyph;
    }
    at += glyph.size();
  }
  return line;
}

}  // namespace firn
