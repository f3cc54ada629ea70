// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The reference solver's own source, embedded by the build from the files that
/// it compiles, so that a lesson shows what really ran.

#include <string_view>
#include <vector>

namespace firn::teach {

struct SourceFile {
  std::string_view path;  ///< from the project's root, "reference/step_01_rasterize.cpp"
  std::string_view text;
};

/// Every file of reference/, sorted by path.
const std::vector<SourceFile>& reference_sources();

}  // namespace firn::teach
