// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/check_set.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "firn/build_info.hpp"
#include "firn/machine.hpp"
#include "firn/registry.hpp"
#include "verification/check/report_text.hpp"

namespace firn {

bool CheckSet::valid() const {
  return std::all_of(reports.begin(), reports.end(),
                     [](const CheckReport& report) { return report.valid(); });
}

std::int64_t CheckSet::compared() const {
  std::int64_t sum = 0;
  for (const CheckReport& report : reports) sum += report.compared();
  return sum;
}

double CheckSet::largest_in_bounds() const {
  double largest = 0;
  for (const CheckReport& report : reports) largest = std::max(largest, report.largest_in_bounds());
  return largest;
}

Exercised CheckSet::exercised() const {
  Exercised all;
  for (const CheckReport& report : reports) all.add(report.exercised);
  return all;
}

std::vector<std::string> CheckSet::not_exercised() const {
  const Exercised all = exercised();
  std::vector<std::string> keys;
  for (const CheckReport& report : reports)
    for (const std::string& key : report.not_exercised)
      if (!met(requirement_of(key), all) && std::find(keys.begin(), keys.end(), key) == keys.end())
        keys.push_back(key);
  return keys;
}

std::string_view verdict_word(const CheckSet& set) {
  if (!set.valid()) return "INVALID";
  return set.interrupted || set.compared() == 0 ? "INCOMPLETE" : "VALID";
}

std::string verdict_line(const CheckSet& set) {
  if (set.valid() && set.compared() == 0) return "INCOMPLETE: nothing was compared";
  return fmt::format("{}: {} numbers compared, largest error {:.2g} of its bound{}",
                     verdict_word(set), set.compared(), set.largest_in_bounds(),
                     check::not_exercised_text(set.not_exercised()));
}

std::string to_table(const CheckSet& set, const TableStyle& style) {
  std::string out;
  if (!set.reports.empty()) {
    const CheckReport& first = set.reports.front();
    out +=
        fmt::format("{} ({}) against {}: the standard set\n\n{:<24} {:>9} {:>6} {:>10} {:>9} {}\n",
                    first.subject, name(first.precision), first.reference, "scene", "particles",
                    "steps", "numbers", "of bound", "verdict");
  }
  const CheckReport* wrong = nullptr;
  for (const CheckReport& report : set.reports) {
    if (wrong == nullptr && !report.valid()) wrong = &report;
    out += fmt::format("{:<24} {:>9} {:>6} {:>10} {:>9.2g} {}\n", report.scene, report.particles,
                       report.steps, report.compared(), report.largest_in_bounds(),
                       check::paint(verdict_word(report), verdict_word(report), style));
  }
  for (const DoesNotApply& each : set.does_not_apply)
    out += fmt::format("{:<24} does not apply: {}\n", each.scene, each.reason);
  out += '\n';
  if (wrong != nullptr)
    out += to_table(*wrong, style);
  else
    out.append("exercised, counted over all compared steps:\n")
        .append(check::exercised_text(set.exercised()));
  const std::string_view word = verdict_word(set);
  out.append("\n").append(check::paint(word, word, style));
  return out.append(verdict_line(set).substr(word.size())).append("\n");
}

std::string to_json(const CheckSet& set) {
  using nlohmann::ordered_json;
  ordered_json json;
  json["schema"] = "firn-check-set";
  json["version"] = 2;
  json["command"] = set.command;
  json["firn_version"] = build_info().version;
  json["git_commit"] = build_info().git_commit;
  json["compiler"] = build_info().compiler;
  json["processor"] = processor_name();
  if (!set.reports.empty()) {
    json["reference"] = set.reports.front().reference;
    json["subject"] = set.reports.front().subject;
    json["precision"] = std::string(name(set.reports.front().precision));
  }
  json["verdict"] = std::string(verdict_word(set));
  json["line"] = verdict_line(set);
  json["compared"] = set.compared();
  json["not_exercised"] = check::not_exercised_json(set.not_exercised());
  json["checks"] = ordered_json::array();
  for (const CheckReport& report : set.reports)
    json["checks"].push_back(ordered_json::parse(to_json(report)));
  json["does_not_apply"] = ordered_json::array();
  for (const DoesNotApply& each : set.does_not_apply)
    json["does_not_apply"].push_back({{"scene", each.scene}, {"reason", each.reason}});
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace firn
