// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firn/diagnostics.hpp"

namespace firn::reference {

/// As firn::measure(), with the reference's own energy density.
Diagnostics measure(const Scene& scene, const State& state);

}  // namespace firn::reference
