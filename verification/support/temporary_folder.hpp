// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A place for the files of one test.

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace firn::fixtures {

/// A fresh folder, removed with everything in it at the end of the test. In memory if `in_memory`
/// and the system has such a place: fsync() costs nothing there.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(bool in_memory = false) {
    const std::filesystem::path shm = "/dev/shm";
    const bool use_shm = in_memory && std::filesystem::is_directory(shm);
    std::string name =
        ((use_shm ? shm : std::filesystem::temp_directory_path()) / "firn-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

  /// The names of what is in it, sorted.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace firn::fixtures
