// SPDX-License-Identifier: BSD-3-Clause
/// The verdict as a table and as JSON.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <nlohmann/json.hpp>

#include "verification/suite/run.hpp"
#include "verification/suite/subject.hpp"

namespace firn::suite {

namespace {

/// One line of the table.
struct Sum {
  std::int64_t numbers = 0;
  int rows = 0, tests = 0, skipped = 0, failed = 0;
  const Row* worst = nullptr;
  std::string why_skipped;
};

Sum sum_of(const Verdict& verdict, const std::string& topic) {
  Sum sum;
  for (const TestResult& test : verdict.tests) {
    if (test.topic != topic) continue;
    ++sum.tests;
    sum.skipped += test.skipped ? 1 : 0;
    sum.failed += test.failed ? 1 : 0;
    if (test.skipped) sum.why_skipped = test.message;
  }
  for (const Row& row : rows()) {
    if (row.topic != topic) continue;
    ++sum.rows;
    sum.numbers += row.numbers;
    if (sum.worst == nullptr || row.largest > sum.worst->largest) sum.worst = &row;
  }
  return sum;
}

/// "0.31", "> bound" where a yes or no failed.
std::string in_bounds(double largest) {
  if (std::isinf(largest)) return "no";
  return largest == 0 ? "0" : fmt::format("{:.2g}", largest);
}

std::string verdict_of(const Sum& sum) {
  if (sum.tests == sum.skipped) return "does not apply";
  return sum.failed > 0 ? "INVALID" : "VALID";
}

std::string subject_name() {
  return fmt::format("{}, {}", subject().solver, name(subject().precision));
}

double largest_in_bounds() {
  double largest = 0;
  for (const Row& row : rows()) largest = std::max(largest, row.largest);
  return largest;
}

}  // namespace

std::string to_table(const Verdict& verdict) {
  std::string out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "{}\n\n{:<15} {:>5} {:>7} {:>12} {:>10}  {:<62} {}\n", subject_name(), "topic",
                 "tests", "checks", "numbers", "max/bound", "nearest to its bound", "verdict");
  for (const Topic& topic : topics()) {
    const Sum sum = sum_of(verdict, topic.name);
    if (sum.tests == 0) continue;
    std::string worst = sum.worst == nullptr
                            ? sum.why_skipped
                            : fmt::format("{}: {}", sum.worst->test, sum.worst->what);
    if (worst.size() > 62) worst = worst.substr(0, 59) + "...";
    fmt::format_to(to, "{:<15} {:>5} {:>7} {:>12} {:>10}  {:<62} {}\n", topic.title,
                   sum.tests - sum.skipped, sum.rows, sum.numbers,
                   sum.worst == nullptr ? "" : in_bounds(sum.worst->largest), worst,
                   verdict_of(sum));
  }
  bool any_failure = false;
  for (const Row& row : rows()) {
    if (row.valid) continue;
    if (!any_failure) out += "\nfailures, each with the command that repeats it:\n";
    any_failure = true;
    const std::string how =
        std::isinf(row.largest) ? "" : fmt::format(": {} of the bound", in_bounds(row.largest));
    fmt::format_to(to, "  {}.{}: {}{}{}{}\n      {}\n", row.topic, row.test, row.what, how,
                   row.detail.empty() ? "" : ": ", row.detail, command_of(row.topic, row.test));
  }
  fmt::format_to(to, "\n{}: {}: {} numbers in {} checks, largest error {} of its bound, {:.0f} s\n",
                 verdict.valid() ? "VALID" : "INVALID", subject_name(), verdict.numbers(),
                 rows().size(), in_bounds(largest_in_bounds()), verdict.seconds);
  return out;
}

std::string to_json(const Verdict& verdict) {
  const auto number = [](double x) -> nlohmann::json {
    if (std::isfinite(x)) return x;
    return std::isnan(x) ? "nan" : "inf";
  };
  nlohmann::json list = nlohmann::json::array(), tests = nlohmann::json::array(),
                 topic_list = nlohmann::json::array();
  for (const Row& row : rows())
    list.push_back({{"topic", row.topic},
                    {"test", row.test},
                    {"check", row.what},
                    {"numbers", row.numbers},
                    {"largest_in_bounds", number(row.largest)},
                    {"error", number(row.error)},
                    {"bound", number(row.bound)},
                    {"valid", row.valid},
                    {"detail", row.detail},
                    {"command", command_of(row.topic, row.test)}});
  for (const TestResult& test : verdict.tests)
    tests.push_back({{"topic", test.topic},
                     {"test", test.name},
                     {"failed", test.failed},
                     {"skipped", test.skipped},
                     {"message", test.message},
                     {"seconds", test.seconds}});
  for (const Topic& topic : topics()) {
    const Sum sum = sum_of(verdict, topic.name);
    if (sum.tests == 0) continue;
    topic_list.push_back({{"topic", topic.title},
                          {"tests", sum.tests - sum.skipped},
                          {"checks", sum.rows},
                          {"numbers", sum.numbers},
                          {"largest_in_bounds", number(sum.worst ? sum.worst->largest : 0)},
                          {"verdict", verdict_of(sum)}});
  }
  const nlohmann::json all = {{"solver", subject().solver},
                              {"precision", name(subject().precision)},
                              {"verdict", verdict.valid() ? "VALID" : "INVALID"},
                              {"numbers", verdict.numbers()},
                              {"seconds", verdict.seconds},
                              {"topics", topic_list},
                              {"tests", tests},
                              {"checks", list}};
  return all.dump(2);
}

}  // namespace firn::suite
