#pragma once
/// Numbers that a guest must not give back in `firn run`; `firn check` judges them itself.

#include <optional>
#include <string>

#include "firn/state.hpp"

namespace firn::guest {

/// "gave v of particle 3 that is not finite", or nothing.
std::optional<std::string> not_finite(const Particles& particles);

}  // namespace firn::guest
