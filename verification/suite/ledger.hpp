// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What was compared, and how near it came to its bound: the numbers behind the verdict.

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace firn::suite {

/// One row: all comparisons of one name in one test.
struct Row {
  std::string topic;         ///< the GoogleTest suite: "Conservation"
  std::string test;          ///< the GoogleTest case
  std::string what;          ///< "momentum of P2G"
  std::int64_t numbers = 0;  ///< comparisons made
  double largest = 0;  ///< largest error in units of its bound; infinite where there is no number
  double error = 0, bound = 0;  ///< the pair that came nearest, in the unit of the quantity
  bool valid = true;
  bool counted = true;  ///< false: a yes or no, or an exception; `largest` is 0 or infinite
  std::string detail;   ///< where the worst of them was
};

/// A measured figure for plots: an error at a resolution, a limit of Δt.
struct Observation {
  std::string suite, name, title;  ///< as in docs/results_schema.md: "accuracy", "stability"
  std::vector<std::pair<std::string, std::variant<double, std::string>>> parameters;
  struct Quantity {
    std::string name, units, meaning;
    double value;
  };
  std::vector<Quantity> quantities;
};

/// |error| ≤ bound, both in the unit of the quantity; a failure of the running test otherwise.
/// Rows of the same name in a test are merged.
void within(const std::string& what, double error, double bound, const std::string& where = {});

/// The same for many numbers whose largest error in units of its bound is known.
void within_all(const std::string& what, std::int64_t numbers, double largest_in_bounds,
                const std::string& where = {});

/// A yes or no.
void expect(const std::string& what, bool holds, const std::string& why_not = {});

void observe(Observation observation);

/// Everything so far, in the order of the tests.
const std::vector<Row>& rows();
const std::vector<Observation>& observations();

/// Adds a row that is no comparison of a test: an exception, a crash.
void add_failure(const std::string& topic, const std::string& test, const std::string& what);

}  // namespace firn::suite
