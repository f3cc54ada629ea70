// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Words and numbers of untrusted text, for the mesh readers.

#include <cstdint>
#include <string>
#include <string_view>

namespace firn {

/// Takes a UTF-8 byte order mark off the front of `text`. Throws InputError for UTF-16, which
/// editors on Windows write.
void skip_byte_order_mark(std::string_view& text, const std::string& where);

/// Takes the next word off the front of `text`; empty at the end.
std::string_view take_word(std::string_view& text);

/// Takes the next line off the front of `text`, without its line end. A
/// backslash at a line's end is left to the caller.
std::string_view take_line(std::string_view& text);

/// A whole word as a finite coordinate of size up to largest_coordinate.
/// Throws InputError.
double to_coordinate(std::string_view word, const std::string& where);

/// `word` as it may stand in a one-line message: printable and short.
std::string quoted(std::string_view word, std::size_t longest = 32);

}  // namespace firn
