// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// One verdict over the checks of several scenes.

#include <string>
#include <vector>

#include "verification/check/check.hpp"

namespace firn {

/// A check that was not made, because the subject says that it does not take such a scene.
struct DoesNotApply {
  std::string scene, reason;
};

struct CheckSet {
  std::vector<CheckReport> reports;
  std::vector<DoesNotApply> does_not_apply;
  bool interrupted = false;
  std::string command;  ///< that repeats the checks; empty: the caller did not say

  bool valid() const;
  std::int64_t compared() const;
  double largest_in_bounds() const;
  Exercised exercised() const;
  /// Keys that a scene calls for and none of the scenes showed.
  std::vector<std::string> not_exercised() const;
};

std::string_view verdict_word(const CheckSet& set);
std::string verdict_line(const CheckSet& set);

/// A row per scene, the table of the first one that is INVALID, the verdict last.
std::string to_table(const CheckSet& set, const TableStyle& style = {});
std::string to_json(const CheckSet& set);

}  // namespace firn
