// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Facts about this build, which results and trajectories store.

#include <string>

namespace firn {

struct BuildInfo {
  std::string version;     ///< "0.1.0"
  std::string git_commit;  ///< abbreviated hash, followed by "+" if the tree had uncommitted
                           ///< changes; "unknown" outside git
  std::string compiler;    ///< "GNU 12.2.0"
  std::string flags;       ///< of the build type
  std::string build_type;
};

const BuildInfo& build_info();

}  // namespace firn
