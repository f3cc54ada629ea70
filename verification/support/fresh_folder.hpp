#pragma once
/// A new, empty folder for one test.

#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

namespace firn {

/// Of its own for each process, so that suites may run at the same time.
inline std::filesystem::path fresh_folder(const std::string& name) {
  auto folder =
      std::filesystem::path(testing::TempDir()) / ("firn-" + std::to_string(getpid()) + "-" + name);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace firn
