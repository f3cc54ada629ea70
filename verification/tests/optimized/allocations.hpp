// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Counts what a test program allocates.

#include <atomic>

namespace firn::test {

/// Calls of operator new since the program began.
extern std::atomic<long> allocations;

}  // namespace firn::test
