// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Pieces that the tables of one check and of several share.

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "verification/check/check.hpp"

namespace firn::check {

/// `text` in the colour of a verdict, if the style has colours.
std::string paint(std::string_view text, std::string_view verdict, const TableStyle& style);

/// "; not exercised: plastic flow, contact", or nothing.
std::string not_exercised_text(const std::vector<std::string>& keys);

/// `head` and the items, comma-separated, in lines of at most 100 columns.
std::string wrapped(const std::string& head, const std::vector<std::string>& items);

/// A line or more per stage: "  5 grid_collisions: 245 nodes slide along a collider".
std::string exercised_text(const Exercised& exercised);

/// [{"key": "contact", "what": "contact", "shown_by": ["node_sticks", …]}, …].
nlohmann::ordered_json not_exercised_json(const std::vector<std::string>& keys);

}  // namespace firn::check
