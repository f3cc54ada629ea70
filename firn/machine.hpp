// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The machine that a result was computed on.

#include <string>

namespace firn {

/// "model name" of the first processor, "unknown" if the system does not say.
std::string processor_name();

/// Processors that this process may run on, ≥ 1.
int available_processors();

}  // namespace firn
