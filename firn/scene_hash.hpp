// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Which scene a result belongs to, in 16 characters.

#include <string>
#include <string_view>

namespace firn {

/// 64-bit FNV-1a, in hexadecimal, of the resolved text of a scene (Scene::toml), without the keys
/// of [time] that change no step: `end` and `frames_per_second`.
std::string scene_hash(std::string_view resolved_toml);

}  // namespace firn
