// SPDX-License-Identifier: BSD-3-Clause
#include "firn/scene_hash.hpp"

#include <algorithm>
#include <cstdint>

namespace firn {

namespace {

bool changes_no_step(std::string_view line) {
  return line.starts_with("end = ") || line.starts_with("frames_per_second = ");
}

}  // namespace

std::string scene_hash(std::string_view resolved_toml) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  bool in_time = false;
  while (!resolved_toml.empty()) {
    const std::size_t end = std::min(resolved_toml.find('\n'), resolved_toml.size() - 1);
    const std::string_view line = resolved_toml.substr(0, end + 1);
    resolved_toml.remove_prefix(end + 1);
    if (line.starts_with('[')) in_time = line.starts_with("[time]");
    if (in_time && changes_no_step(line)) continue;
    for (const char c : line) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  }
  constexpr char digits[] = "0123456789abcdef";
  std::string text(16, '0');
  for (auto digit = text.rbegin(); digit != text.rend(); ++digit, hash >>= 4)
    *digit = digits[hash & 15];
  return text;
}

}  // namespace firn
