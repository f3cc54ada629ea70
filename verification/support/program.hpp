#pragma once
/// Runs the program as a user would.

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace firn::test {

struct Outcome {
  int status = -1;  ///< exit status; 128 + signal if it was killed
  std::string out, err;
};

/// Runs `firn` with these words in `folder`. With `interrupt_after` it gets SIGINT then.
Outcome run_firn(const std::vector<std::string>& words, const std::filesystem::path& folder,
                 std::chrono::milliseconds interrupt_after = {});

/// An empty folder of its own, removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  const std::filesystem::path& path() const { return path_; }
  std::vector<std::string> files() const;

 private:
  std::filesystem::path path_;
};

}  // namespace firn::test
