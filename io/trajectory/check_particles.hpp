// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What must hold for particles from a file.

#include <string>

#include "firn/state.hpp"

namespace firn {

/// Every number finite, masses > 0, volumes ≥ 0, ids unique; else InputError
/// "WHERE, particle P: DATASET: …".
void check_particles(const Particles& particles, const std::string& where);

/// Ids unique; else InputError.
void check_ids(const Particles& particles, const std::string& where);

}  // namespace firn
