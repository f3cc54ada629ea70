// SPDX-License-Identifier: BSD-3-Clause
#include "verification/studies/standard_set.hpp"

#include <algorithm>

#include "verification/support/snow_cases.hpp"

namespace firn::studies {

namespace {

StandardCase standard_case(const fixtures::Case& c) {
  StandardCase result{c.name, c.scene, {{c.state, c.steps}}};
  std::replace(result.name.begin(), result.name.end(), ' ', '_');
  return result;
}

/// True if the chosen rows have every column of `wanted`.
bool covers(const std::vector<std::vector<bool>>& catches, const std::vector<std::size_t>& chosen,
            const std::vector<bool>& wanted) {
  for (std::size_t m = 0; m < wanted.size(); ++m) {
    const bool caught =
        std::any_of(chosen.begin(), chosen.end(), [&](std::size_t c) { return catches[c][m]; });
    if (wanted[m] && !caught) return false;
  }
  return true;
}

/// Extends `chosen` to `size` rows in every possible way, in order, until they cover.
bool extend(const std::vector<std::vector<bool>>& catches, const std::vector<bool>& wanted,
            std::size_t size, std::vector<std::size_t>& chosen) {
  if (chosen.size() == size) return covers(catches, chosen, wanted);
  for (std::size_t c = chosen.empty() ? 0 : chosen.back() + 1; c < catches.size(); ++c) {
    chosen.push_back(c);
    if (extend(catches, wanted, size, chosen)) return true;
    chosen.pop_back();
  }
  return false;
}

}  // namespace

std::vector<StandardCase> candidates() {
  std::vector<StandardCase> list;
  for (const fixtures::Case& c : fixtures::snow_cases()) list.push_back(standard_case(c));
  list.push_back(standard_case(fixtures::far_lump()));
  return list;
}

std::vector<StandardCase> standard_set() {
  const auto is = [](const char* name) {
    return [name](const StandardCase& c) { return c.name == name; };
  };
  std::vector<StandardCase> all = candidates(), chosen;
  for (const char* name : {"periodic_lump", "awkward_lump", "implicit_lump"})
    chosen.push_back(*std::find_if(all.begin(), all.end(), is(name)));
  return chosen;
}

std::vector<std::size_t> smallest_set(const std::vector<std::vector<bool>>& catches) {
  std::vector<std::size_t> chosen;
  if (catches.empty()) return chosen;
  std::vector<bool> wanted(catches[0].size());
  for (const std::vector<bool>& row : catches)
    for (std::size_t m = 0; m < row.size(); ++m) wanted[m] = wanted[m] || row[m];
  for (std::size_t size = 0; size <= catches.size(); ++size)
    if (extend(catches, wanted, size, chosen)) return chosen;
  return chosen;
}

}  // namespace firn::studies
