// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A file's content, for comparisons bit by bit.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace firn {

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

}  // namespace firn
