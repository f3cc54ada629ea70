// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What every reader owes to bytes that are not what it expects.

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "firn/error.hpp"

namespace firn::fuzz {

inline void require(bool holds, const char* what, const std::string& text) {
  if (holds) return;
  std::fprintf(stderr, "%s:\n%s\n", what, text.c_str());
  std::abort();
}

/// An InputError is one line that says first where the bytes came from.
inline void require_message(const InputError& error, std::string_view where) {
  const std::string message = error.what();
  for (const char c : message)
    require(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f, "more than a line", message);
  require(std::string_view(message).substr(0, where.size()) == where, "no file first", message);
}

}  // namespace firn::fuzz
