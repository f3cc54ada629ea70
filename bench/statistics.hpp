// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Medians and spreads of repetitions.

#include <string>
#include <vector>

namespace firn::bench {

/// q-quantile with linear interpolation, q in [0, 1]; NaN of no values.
double quantile(std::vector<double> values, double q);
double median(const std::vector<double>& values);

/// (third quartile − first quartile) / median.
double relative_spread(const std::vector<double>& values);

/// Relative standard error of the median of n repetitions, 1.25 σ/√n with σ from the
/// quartiles of a normal distribution, 1.35 σ apart. Infinite below three repetitions.
double median_error(const std::vector<double>& values);

/// The largest median_error() at which a median is quoted: two of them are the 10 % by which
/// a baseline judges. Repeating a case helps: 9 repetitions may spread over 16 % of the
/// median between their quartiles, 36 over 32 %.
inline constexpr double largest_median_error = 0.05;

std::string percent(double fraction);  ///< "3.2 %"
double three_digits(double value);     ///< rounded to three significant digits

}  // namespace firn::bench
