// SPDX-License-Identifier: BSD-3-Clause
#include "verification/suite/ledger.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>

namespace firn::suite {

namespace {

std::vector<Row> all_rows;
std::vector<Observation> all_observations;

Row& row_of(const std::string& topic, const std::string& test, const std::string& what) {
  for (auto row = all_rows.rbegin(); row != all_rows.rend() && row->test == test; ++row)
    if (row->what == what && row->topic == topic) return *row;
  Row fresh;
  fresh.topic = topic;
  fresh.test = test;
  fresh.what = what;
  all_rows.push_back(std::move(fresh));
  return all_rows.back();
}

Row& row_of_running_test(const std::string& what) {
  const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
  return row_of(info->test_suite_name(), info->name(), what);
}

void add(const std::string& what, std::int64_t numbers, double ratio, double error, double bound,
         const std::string& where) {
  Row& row = row_of_running_test(what);
  row.numbers += numbers;
  const bool valid = ratio <= 1;  // false for NaN
  if (!(ratio <= row.largest)) {
    row.largest = std::isnan(ratio) ? std::numeric_limits<double>::infinity() : ratio;
    row.error = error;
    row.bound = bound;
    row.detail = where;
  }
  if (valid) return;
  // The first failure of a row is reported; the others only make its number larger.
  if (row.valid)
    ADD_FAILURE() << what << ": "
                  << (bound > 0 || error != 0
                          ? fmt::format("{:.6g} where {:.6g} is allowed", error, bound)
                          : fmt::format("{:.4g} of the bound", ratio))
                  << (where.empty() ? "" : ", ") << where;
  row.valid = false;
}

}  // namespace

void within(const std::string& what, double error, double bound, const std::string& where) {
  const double size = std::abs(error);
  const double ratio = size == 0   ? 0
                       : bound > 0 ? size / bound
                                   : std::numeric_limits<double>::infinity();
  add(what, 1, ratio, size, bound, where);
}

void within_all(const std::string& what, std::int64_t numbers, double largest_in_bounds,
                const std::string& where) {
  add(what, numbers, largest_in_bounds, 0, 0, where);
}

void expect(const std::string& what, bool holds, const std::string& why_not) {
  Row& row = row_of_running_test(what);
  row.counted = false;
  ++row.numbers;
  if (holds) return;
  if (row.valid) ADD_FAILURE() << what << (why_not.empty() ? "" : ": ") << why_not;
  row.valid = false;
  row.largest = std::numeric_limits<double>::infinity();
  row.detail = why_not;
}

void observe(Observation observation) { all_observations.push_back(std::move(observation)); }

const std::vector<Row>& rows() { return all_rows; }
const std::vector<Observation>& observations() { return all_observations; }

void add_failure(const std::string& topic, const std::string& test, const std::string& what) {
  Row& row = row_of(topic, test, what);
  row.counted = false;
  row.valid = false;
  row.largest = std::numeric_limits<double>::infinity();
}

}  // namespace firn::suite
