// SPDX-License-Identifier: BSD-3-Clause
/// firn compare: two trajectories, also ones that other programs wrote.

#include "io/trajectory/compare.hpp"

#include <cmath>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/progress.hpp"
#include "cli/verbs.hpp"
#include "firn/error.hpp"

namespace firn::cli {

namespace {

struct CompareArguments {
  std::string a, b;
  double tolerance = 0;
  std::optional<double> time_tolerance;
  bool json = false;
};

/// Same frames, same particles, and no quantity further apart than the tolerance
/// (0: the same bits).
bool passes(const TrajectoryComparison& c, double tolerance) {
  if (c.identical()) return true;
  if (tolerance == 0 || !c.only_in_a.empty() || !c.only_in_b.empty() ||
      !c.particle_mismatches.empty())
    return false;
  for (const QuantityComparison& q : c.quantities)
    if (!(q.max_relative <= tolerance)) return false;
  return true;
}

std::string values_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) {
    if (!text.empty()) text += ' ';
    text += to_text(value);
  }
  return text;
}

nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(to_text(value));
}

nlohmann::json numbers(const std::vector<double>& values) {
  nlohmann::json list = nlohmann::json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

nlohmann::ordered_json to_json(const QuantityComparison& q) {
  nlohmann::ordered_json object = {{"name", q.name},
                                   {"units", q.units},
                                   {"compared", q.compared},
                                   {"different", q.different},
                                   {"identical", q.identical},
                                   {"max_absolute", number(q.max_absolute)},
                                   {"rms_absolute", number(q.rms_absolute)},
                                   {"max_relative", number(q.max_relative)},
                                   {"rms_relative", number(q.rms_relative)}};
  if (q.first_different_time) object["first_different_time"] = number(*q.first_different_time);
  if (q.worst)
    object["worst"] = {{"time", number(q.worst->time)}, {"frame_a", q.worst->frame_a},
                       {"frame_b", q.worst->frame_b},   {"id", q.worst->id},
                       {"a", numbers(q.worst->a)},      {"b", numbers(q.worst->b)}};
  return object;
}

void print_json(const TrajectoryComparison& c, bool passed) {
  nlohmann::ordered_json object = {{"passed", passed},
                                   {"identical", c.identical()},
                                   {"frames_a", c.frames_a},
                                   {"frames_b", c.frames_b},
                                   {"frames_matched", c.frames_matched},
                                   {"max_time_difference", number(c.max_time_difference)},
                                   {"only_in_a", numbers(c.only_in_a)},
                                   {"only_in_b", numbers(c.only_in_b)}};
  for (const ParticleMismatch& m : c.particle_mismatches)
    object["particle_mismatches"].push_back(
        {{"time", number(m.time)}, {"only_in_a", m.only_in_a}, {"only_in_b", m.only_in_b}});
  for (const QuantityComparison& q : c.quantities) object["quantities"].push_back(to_json(q));
  fmt::print("{}\n", object.dump(2));
}

void print_table(const CompareArguments& arguments, const TrajectoryComparison& c, bool passed) {
  fmt::print("A {}: {} frames\nB {}: {} frames; {} matched by time\n", arguments.a, c.frames_a,
             arguments.b, c.frames_b, c.frames_matched);
  if (!c.times_identical)
    fmt::print("times of matched frames differ by up to {:.3g} s\n", c.max_time_difference);
  if (!c.only_in_a.empty()) fmt::print("only in A: t = {} s\n", values_text(c.only_in_a));
  if (!c.only_in_b.empty()) fmt::print("only in B: t = {} s\n", values_text(c.only_in_b));
  for (const ParticleMismatch& m : c.particle_mismatches)
    fmt::print("t = {} s: {} particles only in A, {} only in B\n", to_text(m.time), m.only_in_a,
               m.only_in_b);
  fmt::print("{:<10} {:>10} {:>10} {:>11} {:>11} {:>11} {:>11}  {}\n", "quantity", "compared",
             "different", "max abs", "rms abs", "max rel", "rms rel", "first at");
  for (const QuantityComparison& q : c.quantities)
    fmt::print(
        "{:<10} {:>10} {:>10} {:>11.3g} {:>11.3g} {:>11.3g} {:>11.3g}  {}\n", q.name, q.compared,
        q.different, q.max_absolute, q.rms_absolute, q.max_relative, q.rms_relative,
        q.first_different_time ? fmt::format("t = {} s", to_text(*q.first_different_time)) : "-");
  for (const QuantityComparison& q : c.quantities)
    if (q.worst && !q.identical)
      fmt::print("worst {}: particle {} at t = {} s\n  A {}\n  B {}\n", q.name, q.worst->id,
                 to_text(q.worst->time), values_text(q.worst->a), values_text(q.worst->b));
  if (c.identical())
    fmt::print("IDENTICAL, bit for bit\n");
  else if (passed)
    fmt::print("SAME within {} relative\n", to_text(arguments.tolerance));
  else
    fmt::print("DIFFERENT\n");
}

int run_compare(const CompareArguments& arguments) {
  if (!(arguments.tolerance >= 0 && arguments.tolerance < 1e300))
    throw InputError("--tolerance", "relative difference allowed", to_text(arguments.tolerance),
                     "finite, at least 0");
  CompareOptions options;
  options.time_tolerance = arguments.time_tolerance;
  if (options.time_tolerance && !(*options.time_tolerance >= 0 && *options.time_tolerance < 1e300))
    throw InputError("--time-tolerance", "difference in s", to_text(*options.time_tolerance),
                     "finite, at least 0");
  std::optional<Waiting> waiting("comparing");
  const TrajectoryComparison comparison = compare_trajectories(arguments.a, arguments.b, options);
  waiting.reset();
  const bool passed = passes(comparison, arguments.tolerance);
  if (arguments.json)
    print_json(comparison, passed);
  else
    print_table(arguments, comparison, passed);
  return passed ? exit_done : exit_failed;
}

}  // namespace

void add_compare(CLI::App& app, Context& context) {
  CLI::App* verb =
      app.add_subcommand("compare", "compares two trajectories; exit status 1 if they differ");
  auto arguments = std::make_shared<CompareArguments>();
  verb->add_option("A", arguments->a, "trajectory")->required();
  verb->add_option("B", arguments->b, "trajectory")->required();
  verb->add_option("--tolerance", arguments->tolerance,
                   "largest relative difference that still passes; 0: every bit must be the same")
      ->capture_default_str();
  verb->add_option("--time-tolerance", arguments->time_tolerance,
                   "frames belong together if their times differ by at most this [s]; default: "
                   "rounding, also that of times kept in 32 bits");
  verb->add_flag("--json", arguments->json, "print JSON");
  verb->callback([arguments, &context] { context.exit = run_compare(*arguments); });
}

}  // namespace firn::cli
