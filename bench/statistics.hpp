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

/// The widest relative_spread() at which a median may be quoted. Shared machines
/// wander by up to 1.5x; half the repetitions within 20 % leave the median of
/// seven good to about 10 %.
inline constexpr double widest_spread = 0.20;

std::string percent(double fraction);  ///< "3.2 %"
double three_digits(double value);     ///< rounded to three significant digits

}  // namespace firn::bench
