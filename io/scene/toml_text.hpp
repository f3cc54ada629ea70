// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Values as TOML spells them, so that they read back as the same values.

#include <string>

#include "firn/types.hpp"

namespace firn {

/// A basic string. Not for control characters, which TomlTable::text() refuses.
std::string toml_string(const std::string& text);

/// A float; infinity as the string "inf", as the scene format writes it.
std::string toml_number(double value);

/// An array of three floats.
std::string toml_vector(const Vec3& value);

}  // namespace firn
