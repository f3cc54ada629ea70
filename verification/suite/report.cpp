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

/// "0.31"; "no" where a yes or no failed, "not finite" where there is no number to compare.
std::string in_bounds(const Row& row) {
  if (std::isinf(row.largest)) return row.counted ? "not finite" : "no";
  return row.largest == 0 ? "0" : fmt::format("{:.2g}", row.largest);
}

std::string verdict_of(const Sum& sum) {
  if (sum.tests == sum.skipped) return "does not apply";
  return sum.failed > 0 ? "INVALID" : "VALID";
}

std::string subject_name() {
  return fmt::format("{}, {}", subject().solver, name(subject().precision));
}

/// NO VERDICT where no test applied.
const char* word_of(const Verdict& verdict) {
  if (verdict.valid()) return "VALID";
  const bool failed = std::any_of(verdict.tests.begin(), verdict.tests.end(),
                                  [](const TestResult& test) { return test.failed; });
  return failed ? "INVALID" : "NO VERDICT";
}

/// "largest error 0.31 of its bound", of the rows that have one; then how many rows failed.
std::string largest_error() {
  const Row* worst = nullptr;
  std::int64_t failed = 0;
  for (const Row& row : rows()) {
    failed += row.valid ? 0 : 1;
    if (row.counted && (worst == nullptr || row.largest > worst->largest)) worst = &row;
  }
  std::string text;
  if (worst != nullptr && std::isinf(worst->largest))
    text = ", an error that is not finite";
  else if (worst != nullptr)
    text = fmt::format(", largest error {} of its bound", in_bounds(*worst));
  if (failed > 0) text += fmt::format(", {} {} failed", failed, failed == 1 ? "check" : "checks");
  return text;
}

/// "; does not apply: semi-implicit, 3 of 5 in dynamics", or nothing.
std::string not_applied(const Verdict& verdict) {
  std::string text;
  for (const Topic& topic : topics()) {
    const Sum sum = sum_of(verdict, topic.name);
    if (sum.skipped == 0) continue;
    text += text.empty() ? "; does not apply: " : ", ";
    if (sum.skipped < sum.tests) text += fmt::format("{} of {} in ", sum.skipped, sum.tests);
    text += topic.title;
  }
  return text;
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
                   sum.worst == nullptr ? "" : in_bounds(*sum.worst), worst, verdict_of(sum));
  }
  bool any_failure = false;
  for (const Row& row : rows()) {
    if (row.valid) continue;
    if (!any_failure) out += "\nfailures, each with the command that repeats it:\n";
    any_failure = true;
    const std::string how =
        std::isinf(row.largest) ? "" : fmt::format(": {} of the bound", in_bounds(row));
    fmt::format_to(to, "  {}.{}: {}{}{}{}\n      {}\n", row.topic, row.test, row.what, how,
                   row.detail.empty() ? "" : ": ", row.detail, command_of(row.topic, row.test));
  }
  fmt::format_to(to, "\n{}: {}: {} numbers in {} checks{}, {:.0f} s{}\n", word_of(verdict),
                 subject_name(), verdict.numbers(), rows().size(), largest_error(), verdict.seconds,
                 not_applied(verdict));
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
                              {"verdict", word_of(verdict)},
                              {"numbers", verdict.numbers()},
                              {"seconds", verdict.seconds},
                              {"topics", topic_list},
                              {"tests", tests},
                              {"checks", list}};
  return all.dump(2);
}

}  // namespace firn::suite
