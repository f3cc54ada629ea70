// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/report_text.hpp"

#include <fmt/format.h>

namespace firn::check {

std::string paint(std::string_view text, std::string_view verdict, const TableStyle& style) {
  if (!style.colour) return std::string(text);
  const char* code = verdict == "VALID" ? "32" : verdict == "INVALID" ? "31" : "33";
  return fmt::format("\x1b[{}m{}\x1b[0m", code, text);
}

std::string not_exercised_text(const std::vector<std::string>& keys) {
  std::string text;
  for (const std::string& key : keys)
    text.append(text.empty() ? "; not exercised: " : ", ").append(requirement_of(key).phrase);
  return text;
}

std::string wrapped(const std::string& head, const std::vector<std::string>& items) {
  std::string out, line = head;
  for (std::size_t k = 0; k < items.size(); ++k) {
    const std::string item = items[k] + (k + 1 < items.size() ? "," : "");
    if (line.size() + 1 + item.size() > 100) {
      out += line + '\n';
      line = std::string(4, ' ') + item;
    } else {
      line += ' ' + item;
    }
  }
  return out + line + '\n';
}

std::string exercised_text(const Exercised& exercised) {
  std::string out;
  for (const Stage stage : all_stages) {
    std::vector<std::string> items;
    for (const FeatureName& feature : feature_names())
      if (feature.stage == stage && exercised[feature.feature] > 0)
        items.push_back(
            fmt::format("{} {} {}", exercised[feature.feature], feature.of, feature.phrase));
    if (stage == Stage::integration && exercised.iterations() > 0)
      items.push_back(fmt::format("{} iterations", exercised.iterations()));
    if (!items.empty()) out += wrapped(fmt::format("  {} {}:", number(stage), name(stage)), items);
  }
  return out;
}

}  // namespace firn::check
