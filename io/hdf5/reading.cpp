// SPDX-License-Identifier: BSD-3-Clause
#include "io/hdf5/reading.hpp"

#include <csignal>
#include <cstring>

namespace firn::hdf5 {

namespace {

volatile std::sig_atomic_t depth = 0;
char last_path[1024] = "";

}  // namespace

Reading::Reading() noexcept { depth = depth + 1; }

Reading::Reading(const std::filesystem::path& path) noexcept : Reading() {
  std::strncpy(last_path, path.c_str(), sizeof last_path - 1);
}

Reading::~Reading() { depth = depth - 1; }

const char* file_being_read() noexcept { return depth > 0 ? last_path : nullptr; }

}  // namespace firn::hdf5
