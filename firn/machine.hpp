#pragma once
/// The machine that a result was computed on.

#include <string>

namespace firn {

/// "model name" of the first processor, "unknown" where the system does not tell.
std::string processor_name();

/// Processors that this process may run on, ≥ 1.
int available_processors();

}  // namespace firn
