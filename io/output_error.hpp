// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The third way to fail: the disk (firn/error.hpp has the other two).

#include <stdexcept>

namespace firn {

/// A file that was being written cannot be written any further (exit 3). What
/// was reported as written before is still there.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace firn
