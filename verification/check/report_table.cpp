// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <string>
#include <tuple>

#include "firn/registry.hpp"
#include "verification/check/check.hpp"
#include "verification/check/report_text.hpp"

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

std::string_view verdict_word(const CheckReport& report) {
  if (!report.valid()) return "INVALID";
  return report.interrupted || report.compared() == 0 ? "INCOMPLETE" : "VALID";
}

namespace {

/// Rows that a table shows unless all are asked for.
constexpr std::size_t rows_shown = 12;

std::string_view mode_name(CheckMode mode) {
  return mode == CheckMode::lockstep ? "lockstep" : "free";
}

/// A stretch in the width of a table: the stage's name, or "1-10 whole step", or "3-6".
std::string short_range(Stage from, Stage through) {
  if (from == through) return stage_range(from, through);
  const bool whole = from == Stage::rasterize && through == Stage::positions;
  return fmt::format("{}-{}{}", number(from), number(through), whole ? " whole step" : "");
}

/// "p12[x]", "(3,4,5)[y]".
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

/// What failed first, by the size of the error; then the others likewise.
std::vector<const FieldCheck*> in_order(const CheckReport& report, bool all) {
  std::vector<const FieldCheck*> rows;
  for (const FieldCheck& row : report.fields)
    if (!row.kept || !row.valid) rows.push_back(&row);
  if (all) return rows;
  std::stable_sort(rows.begin(), rows.end(), [](const FieldCheck* a, const FieldCheck* b) {
    if (a->valid != b->valid) return !a->valid;
    return a->largest_in_bounds > b->largest_in_bounds;
  });
  std::size_t failed = 0;
  while (failed < rows.size() && !rows[failed]->valid) ++failed;
  rows.resize(std::min(rows.size(), std::max(failed, rows_shown)));
  return rows;
}

class Table {
 public:
  explicit Table(const TableStyle& style) : style_(style) {}

  void field(const FieldCheck& row) {
    std::string line =
        fmt::format("{:<22} {:<14} {:<5} {:>10} ", short_range(row.from, row.through),
                    name(row.field), units(row.field), row.compared);
    if (row.compared == 0) {
      out_ += line + "nothing to compare\n";
      return;
    }
    const std::string relative =
        row.reference_size > 0 ? fmt::format("{:.1e}", row.largest_relative) : "-";
    line += fmt::format("{:>8.1e} {:>8} {:>8.2g} {:<16}", row.largest_absolute, relative,
                        row.largest_in_bounds, place_text(row));
    while (line.back() == ' ') line.pop_back();
    out_ += (row.valid ? line : check::paint(line, "INVALID", style_)) + '\n';
    if (row.valid) return;
    fmt::format_to(std::back_inserter(out_),
                   "    {} of {} wrong{}; the worst in step {}: {:.9g}, should be {:.9g}\n",
                   row.wrong, row.compared, row.kept ? ", though no stage here writes them" : "",
                   row.worst.step, row.worst.subject_value, row.worst.reference_value);
    for (const std::string& text : row.diagnosis) out_.append("    ").append(text).append("\n");
  }

  std::string& text() { return out_; }

 private:
  TableStyle style_;
  std::string out_;
};

/// Wrong by how much of the field's size.
double relative_error(const FieldCheck& row) {
  if (!std::isfinite(row.largest_absolute)) return row.largest_absolute;
  return row.reference_size > 0 ? row.largest_absolute / row.reference_size : 1e300;
}

/// The wrong row whose error is physically the largest: of single stages where there are such,
/// and light nodes only where nothing else is wrong. Null if no field is wrong.
const FieldCheck* largest_error(const CheckReport& report) {
  const FieldCheck* largest = nullptr;
  const auto rank = [](const FieldCheck& row) {
    const bool pinned_down = row.from == row.through || row.from != Stage::rasterize;
    return std::make_tuple(row.only_light_nodes == 0, pinned_down, relative_error(row));
  };
  for (const FieldCheck& row : report.fields)
    if (!row.valid && (largest == nullptr || rank(row) > rank(*largest))) largest = &row;
  return largest;
}

std::string headline(const FieldCheck& row) {
  std::string text = fmt::format(
      "largest error: stage {}, {}: ", stage_range(row.from, row.through), name(row.field));
  if (row.non_finite > 0)
    text += fmt::format("{} numbers are not finite", row.non_finite);
  else if (row.reference_size > 0)
    text += fmt::format("{:.2g} of the field's size", relative_error(row));
  else
    text +=
        fmt::format("{:.2g} {} where the reference is 0", row.largest_absolute, units(row.field));
  if (!row.diagnosis.empty()) text.append("; ").append(row.diagnosis.front());
  if (row.only_light_nodes > 0)
    text += fmt::format(
        "\nonly nodes lighter than {:.1g} m_p differ: a kernel in expanded form loses its digits "
        "there",
        row.only_light_nodes);
  return text;
}

/// "steps 0 and 159 to 160": the scene's steps that were compared.
std::string windows_text(const CheckReport& report) {
  std::string text;
  for (const CheckedWindow& window : report.windows) {
    text += text.empty() ? "" : ", ";
    const std::int64_t last = window.start_step + std::max<std::int64_t>(window.steps, 1) - 1;
    text += window.start_step == last ? fmt::format("{}", last)
                                      : fmt::format("{} to {}", window.start_step, last);
  }
  return text;
}

}  // namespace

std::string verdict_line(const CheckReport& report) {
  if (report.compared() == 0 && report.valid()) return "INCOMPLETE: nothing was compared";
  return fmt::format("{}: {} numbers compared, largest error {:.2g} of its bound{}{}",
                     verdict_word(report), report.compared(), report.largest_in_bounds(),
                     check::not_exercised_text(report.not_exercised), not_judged_text(report));
}

std::string to_table(const CheckReport& report, const TableStyle& style) {
  Table table(style);
  std::string& out = table.text();
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "{} ({}) against {}: scene {}, {} particles, {}\n", report.subject,
                 name(report.precision), report.reference, report.scene, report.particles,
                 mode_name(report.mode));
  out += check::wrapped("steps", {windows_text(report)});
  fmt::format_to(to, "\n{:<22} {:<14} {:<5} {:>10} {:>8} {:>8} {:>8} {}\n", "stage", "field",
                 "unit", "numbers", "max err", "max rel", "of bound", "worst at");
  const std::vector<const FieldCheck*> rows = in_order(report, style.all_rows);
  for (const FieldCheck* row : rows) table.field(*row);
  std::size_t all = 0;
  for (const FieldCheck& row : report.fields) all += !row.kept || !row.valid;
  if (all > rows.size())
    fmt::format_to(to, "{} more rows within their bounds: --all shows them\n", all - rows.size());
  if (!report.properties.empty()) out += '\n';
  for (const PropertyCheck& row : report.properties) {
    fmt::format_to(to, "{:<52} {:>10} {}\n", row.name, row.compared,
                   row.valid ? "holds" : check::paint("does not hold", "INVALID", style));
    if (!row.detail.empty()) fmt::format_to(to, "    {}\n", row.detail);
  }
  if (report.exercised.steps() > 0)
    out +=
        "\nexercised, counted over all compared steps:\n" + check::exercised_text(report.exercised);
  out += '\n';
  if (report.first_divergence) {
    const Divergence& first = *report.first_divergence;
    fmt::format_to(to, "first divergence: step {}, stage {}{}{}: {}\n", first.step,
                   stage_range(first.from, first.through), first.field ? ", " : "",
                   first.field ? name(*first.field) : "", first.message);
  }
  if (const FieldCheck* row = largest_error(report)) out += headline(*row) + '\n';
  const std::string line = verdict_line(report);
  const std::size_t word = line.find(':');
  out += check::paint(line.substr(0, word), verdict_word(report), style) + line.substr(word) + '\n';
  return out;
}

}  // namespace firn
