// SPDX-License-Identifier: BSD-3-Clause
#include "bench/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firn/error.hpp"

namespace firn::bench {

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double place = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

double median(const std::vector<double>& values) { return quantile(values, 0.5); }

double relative_spread(const std::vector<double>& values) {
  return (quantile(values, 0.75) - quantile(values, 0.25)) / std::abs(median(values));
}

double median_error(const std::vector<double>& values) {
  if (values.size() < 3) return std::numeric_limits<double>::infinity();
  return 1.25 / 1.35 * relative_spread(values) / std::sqrt(static_cast<double>(values.size()));
}

double three_digits(double value) {
  if (value == 0 || !std::isfinite(value)) return value;
  const double unit = std::pow(10.0, 2 - std::floor(std::log10(std::abs(value))));
  return std::round(value * unit) / unit;
}

std::string percent(double fraction) { return to_text(std::round(1000 * fraction) / 10) + " %"; }

}  // namespace firn::bench
