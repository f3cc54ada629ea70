// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <string>

#include "firn/registry.hpp"
#include "verification/check/check.hpp"

namespace firn {

std::int64_t CheckReport::compared() const {
  std::int64_t sum = 0;
  for (const FieldCheck& row : fields) sum += row.compared;
  for (const PropertyCheck& row : properties) sum += row.compared;
  return sum;
}

double CheckReport::largest_in_bounds() const {
  double largest = 0;
  for (const FieldCheck& row : fields) largest = std::max(largest, row.largest_in_bounds);
  return largest;
}

std::string stage_range(Stage from, Stage through) {
  if (from == through) return fmt::format("{} {}", number(through), name(through));
  return fmt::format("{}-{} {}..{}", number(from), number(through), name(from), name(through));
}

namespace {

std::string_view mode_name(CheckMode mode) {
  return mode == CheckMode::lockstep ? "lockstep" : "free";
}

std::string_view verdict_word(bool valid) { return valid ? "VALID" : "INVALID"; }

/// "particle 12 [x]", "node (3,4,5) [y]".
std::string place_text(const FieldCheck& row) {
  const Place& place = row.worst;
  static constexpr const char* axes[] = {"[x]", "[y]", "[z]"};
  std::string component;
  switch (row.field) {
    case Field::node_mass:
    case Field::particle_volume: break;
    case Field::particle_F_E:
    case Field::particle_F_P:
    case Field::node_free_directions:
      component = fmt::format("[{},{}]", place.component / 3, place.component % 3);
      break;
    default: component = axes[place.component % 3];
  }
  if (place.is_node)
    return fmt::format("({},{},{}){}", place.node.i, place.node.j, place.node.k, component);
  return fmt::format("p{}{}", place.id, component);
}

void field_row(std::string& out, const FieldCheck& row) {
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "{:<38} {:<15} {:<4} {:>10} ", stage_range(row.from, row.through),
                 fmt::format("{}{}", name(row.field), row.kept ? " kept" : ""), units(row.field),
                 row.compared);
  if (row.compared == 0) {
    fmt::format_to(to, "{:<99} {}\n", "nothing to compare", verdict_word(row.valid));
    return;
  }
  fmt::format_to(to, "{:>8.1e} {:>8.1e} {:>8.1e} {:>8.1e} {:>8.2g} {:>8.2g} ", row.largest_absolute,
                 row.rms_absolute, row.largest_relative, row.rms_relative, row.largest_in_bounds,
                 row.rms_in_bounds);
  fmt::format_to(to, "{:>5} {:<16} {:>12.5g} {:>9.1e} {}\n", row.worst.step, place_text(row),
                 row.worst.reference_value, row.worst.subject_value - row.worst.reference_value,
                 verdict_word(row.valid));
}

}  // namespace

std::string to_table(const CheckReport& report) {
  std::string out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "{} ({}) against {}: scene {}, {} particles, {}, steps {} to {}\n\n",
                 report.subject, name(report.precision), report.reference, report.scene,
                 report.particles, mode_name(report.mode), report.start_step,
                 report.start_step + report.steps);
  fmt::format_to(to,
                 "{:<38} {:<15} {:<4} {:>10} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>5} {:<16} "
                 "{:>12} {:>9} {}\n",
                 "stages", "field", "unit", "values", "max abs", "rms abs", "max rel", "rms rel",
                 "max/bnd", "rms/bnd", "step", "worst at", "reference", "error", "verdict");
  for (const FieldCheck& row : report.fields)
    if (!row.kept || !row.valid) field_row(out, row);
  if (!report.properties.empty()) out += '\n';
  for (const PropertyCheck& row : report.properties)
    fmt::format_to(to, "{:<69} {:>10} {}{}{}\n", row.name, row.compared, verdict_word(row.valid),
                   row.detail.empty() ? "" : ": ", row.detail);
  out += '\n';
  if (report.first_divergence) {
    const Divergence& first = *report.first_divergence;
    fmt::format_to(to, "first divergence: step {}, stage {}{}{}: {}\n", first.step,
                   stage_range(first.from, first.through), first.field ? ", " : "",
                   first.field ? name(*first.field) : "", first.message);
  }
  fmt::format_to(to, "{}: {} numbers compared, largest error {:.2g} of its bound\n",
                 verdict_word(report.valid()), report.compared(), report.largest_in_bounds());
  return out;
}

}  // namespace firn
