// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Runs the program as a user would.

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "verification/support/temporary_folder.hpp"

namespace firn::fixtures {

struct Outcome {
  int status = -1;  ///< exit status; 128 + signal if it was killed
  std::string out, err;
};

/// Runs `firn` with these words in `folder`. With `interrupt_after` it gets SIGINT then.
Outcome run_firn(const std::vector<std::string>& words, const std::filesystem::path& folder,
                 std::chrono::milliseconds interrupt_after = {});

}  // namespace firn::fixtures
