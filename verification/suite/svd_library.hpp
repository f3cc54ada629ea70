// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A tester for anybody's singular value decomposition, in a shared library.

#include <string>

namespace firn::suite {

struct SvdReport {
  bool valid = false;
  std::string table;  ///< one row per family, the verdict last
};

/// Loads the functions of firn_svd.h from the library and tests those that it has. They run in a
/// process of their own: a crash, or no answer within `time_limit` seconds, is the library's
/// fault and says so. Throws InputError if there is none of them.
SvdReport verify_svd_library(const std::string& path, double time_limit);

}  // namespace firn::suite
