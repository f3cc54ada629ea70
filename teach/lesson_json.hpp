// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A lesson as JSON text. Numbers are the shortest decimals that read back as the
/// same double, so what a page prints is what the solver computed.

#include <nlohmann/json.hpp>

#include "teach/lesson.hpp"

namespace firn::teach {

nlohmann::ordered_json to_json(const Lesson& lesson);

}  // namespace firn::teach
