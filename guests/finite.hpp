// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Non-finite numbers, which a guest must not return in `firn run`; `firn check` finds them itself.

#include <optional>
#include <string>

#include "firn/state.hpp"

namespace firn::guest {

/// "returned v of particle 3 that is not finite", or nothing.
std::optional<std::string> not_finite(const Particles& particles);

}  // namespace firn::guest
