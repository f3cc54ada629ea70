// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Untrusted text, made safe for a one-line message.

#include <cstddef>
#include <string>
#include <string_view>

namespace firn {

/// `text` on one line: control characters, line separators and broken UTF-8 as
/// \xNN, cut after `longest` bytes (0: never).
std::string one_line(std::string_view text, std::size_t longest = 0);

}  // namespace firn
